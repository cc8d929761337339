"""The site: `python -m pip install ".[docs]" && python -m sphinx -W -j auto docs build/docs`."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "site"))

import docstrings  # noqa: E402
import gallery  # noqa: E402
import public_names  # noqa: E402
import reference  # noqa: E402
import rooms  # noqa: E402
import signatures  # noqa: E402
from sphinx.util import logging  # noqa: E402

import graphdyn  # noqa: E402
from crosscheck.report.records.docstrings import names_of  # noqa: E402

project = "graphdyn"
author = "the graphdyn authors"
copyright = "the graphdyn authors"
release = version = graphdyn.__version__

extensions = ["myst_nb", "sphinx.ext.autodoc", "formulas", "guides"]
exclude_patterns = ["site", "schemas", "rooms"]
default_role = "code"
myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence"]
myst_heading_anchors = 3
autodoc_typehints = "signature"
autodoc_type_aliases = {name: name for name in ("Array", "ArrayLike", "Method", "Coordinates")}
autodoc_member_order = "bysource"
python_maximum_signature_line_length = 88
toc_object_entries_show_parents = "hide"
nb_execution_mode = "cache"
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 300
html_math_renderer = "svg"
html_theme = "furo"
html_title = "graphdyn"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sphinx = False
html_extra_path = ["gallery/pages"]
LINKS = public_names.links()


def process_docstring(app, what, name, thing, options, lines):
    title = "Attributes" if what in ("class", "exception") else "Parameters"
    lines[:] = docstrings.as_rst(lines, names_of(thing), title, LINKS)


def process_signature(app, what, name, thing, options, signature, returned):
    return signatures.readable(signature), signatures.readable(returned)


def write_pages(app, config):
    reference.write(HERE / "reference")
    rooms.write(HERE / "rooms")
    exhibits = () if app.tags.has("nogallery") else gallery.EXHIBITS
    gallery.write(HERE / "gallery", exhibits + gallery.SLOW if app.tags.has("bench") else exhibits)


def check_names(app, env):
    documented = env.get_domain("py").objects
    for name in reference.missing(documented):
        logging.getLogger(__name__).warning("public name without an entry: %s", name)


def setup(app):
    app.connect("config-inited", write_pages)
    app.connect("autodoc-process-docstring", process_docstring)
    app.connect("autodoc-process-signature", process_signature)
    app.connect("env-check-consistency", check_names)
