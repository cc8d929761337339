"""Files of Python code that a user names: FILE.py:NAME."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType


def module_of_file(path: Path) -> ModuleType:
    """A file as a module, which can import other files of its folder. Raises whatever the file raises."""
    sys.path.insert(0, str(path.resolve().parent))
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    return module
