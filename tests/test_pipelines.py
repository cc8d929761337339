"""What the repositories of others call: the GitHub action, the hooks of pre-commit, the files that docs/ci.md shows."""

import json
import os
import re
import subprocess
import sys
import tomllib

import pytest
import yaml
from inspected.sample import CLEAN, INERTIA, changed
from shared_data import REPOSITORY
from shown.sarif_rules import results_of
from typer.testing import CliRunner

from crosscheck.commands import app

ACTION = yaml.safe_load((REPOSITORY / "action.yml").read_text(encoding="utf-8"))
STEPS = {step.get("name", step.get("uses")): step for step in ACTION["runs"]["steps"]}
HOOKS = {hook["id"]: hook for hook in yaml.safe_load((REPOSITORY / ".pre-commit-hooks.yaml").read_text("utf-8"))}
PAGE = (REPOSITORY / "docs/ci.md").read_text(encoding="utf-8")
SHOWN = [yaml.safe_load(text) for text in re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)]
EXTRAS = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))["project"]["optional-dependencies"]
DOUBTFUL = changed(INERTIA, INERTIA.replace("0.11", "0.9"))


@pytest.fixture
def foreign(tmp_path):
    """A repository with a doubtful robot, and a program graphdyn that is this one."""
    (tmp_path / "urdf").mkdir()
    (tmp_path / "urdf" / "arm.urdf").write_text(DOUBTFUL, encoding="utf-8")
    program = tmp_path / "bin" / "graphdyn"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec {sys.executable} -m crosscheck "$@"\n', encoding="utf-8")
    program.chmod(0o755)
    return tmp_path


def done(step, folder, **inputs):
    """The shell of a step of the action, as GitHub runs it, with these inputs."""
    given = {name: value["default"] for name, value in ACTION["inputs"].items()} | inputs
    filled = {
        name: re.sub(r"\$\{\{ inputs\.([\w-]+) \}\}", lambda found: given[found[1]], text)
        for name, text in STEPS[step]["env"].items()
    }
    paths = {"PATH": f"{folder / 'bin'}:{os.environ['PATH']}", "PYTHONPATH": str(REPOSITORY)}
    shell = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", STEPS[step]["run"]]
    return subprocess.run(shell, cwd=folder, env={**os.environ, **filled, **paths}, capture_output=True, text=True)


class TestAction:
    def test_steps(self, foreign):
        """A doubtful inertia fails the inspection at its line; the cross-check goes on; both leave their files."""
        inspected = done("inspect", foreign, robots="urdf", **{"fail-on": "warning"})
        assert (inspected.returncode, inspected.stderr) == (1, "")
        compared = done("crosscheck", foreign, robots="urdf", samples="1")
        assert compared.returncode == 0, compared.stderr
        results = foreign / STEPS["upload"]["with"]["sarif_file"]
        assert {path.name for path in results.iterdir()} == {
            f"{name}.{suffix}" for name in ("inspect", "crosscheck") for suffix in ("sarif", "xml")
        }
        found = results_of(json.loads((results / "inspect.sarif").read_text(encoding="utf-8")))
        places = [
            result["locations"][0]["physicalLocation"] for result in found if result["ruleId"] == "triangle-inequality"
        ]
        assert places == [{"artifactLocation": {"uri": "urdf/arm.urdf"}, "region": {"startLine": 7}}]
        assert results_of(json.loads((results / "crosscheck.sarif").read_text(encoding="utf-8"))) == []

    def test_baseline_and_waivers(self, foreign):
        (foreign / "w.toml").write_text('[[waiver]]\ncode = "inconsistent-body"\nreason = "a test"\n', encoding="utf-8")
        done("inspect", foreign, robots="urdf")
        (foreign / "graphdyn-results" / "inspect.sarif").rename(foreign / "known file.sarif")
        chosen = {"fail-on": "warning", "baseline": "known file.sarif", "waivers": "w.toml"}
        again = done("inspect", foreign, robots="urdf/arm.urdf", **chosen)
        assert again.returncode == 0, again.stderr
        assert "Accepted: 1 in the baseline, 1 waived." in again.stdout

    def test_installation(self):
        """Replaced in the other tests: it installs what lies beside action.yml, with an extra that exists."""
        assert STEPS["install"]["env"] == {"SOURCE": "${{ github.action_path }}"}
        (extra,) = re.fullmatch(r'python -m pip install --quiet "\$SOURCE\[(\w+)\]"', STEPS["install"]["run"]).groups()
        assert extra in EXTRAS

    def test_inputs(self):
        """No input is pasted into a shell, and every input is used."""
        shells = [step["run"] for step in STEPS.values() if "run" in step]
        assert not any("${{" in shell for shell in shells)
        used = set(re.findall(r"inputs\.([\w-]+)", json.dumps(ACTION["runs"])))
        assert used == set(ACTION["inputs"])


class TestHooks:
    @pytest.mark.parametrize("name", HOOKS)
    def test_entry(self, name, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "arm.urdf").write_text(CLEAN, encoding="utf-8")
        program, *arguments = HOOKS[name]["entry"].replace("100", "1").split()
        assert program == "graphdyn"
        assert CliRunner().invoke(app, [*arguments, "arm.urdf"]).exit_code == 0

    def test_files(self):
        robots = ("urdf/arm.urdf", "arm.urdf.xacro", "macros.xacro", "arm.urdf.bak")
        chosen = {name: [file for file in robots if re.search(hook["files"], file)] for name, hook in HOOKS.items()}
        assert chosen == {"graphdyn-inspect": [*robots[:2]], "graphdyn-crosscheck": [robots[0]]}

    def test_packages(self):
        assert HOOKS["graphdyn-inspect"]["additional_dependencies"] == EXTRAS["xacro"]


class TestPage:
    GITHUB, GITLAB, PRE_COMMIT = SHOWN

    def test_the_action(self):
        (*_, step) = self.GITHUB["jobs"]["graphdyn"]["steps"]
        assert step["uses"].startswith("graphdyn/graphdyn@")
        assert set(step["with"]) <= set(ACTION["inputs"])
        assert self.GITHUB["permissions"]["security-events"] == "write"

    def test_the_commands_of_gitlab(self):
        commands = [line.split() for line in self.GITLAB["graphdyn"]["script"] if line.startswith("graphdyn ")]
        for _, command, _, *options in commands:
            known = CliRunner().invoke(app, [command, "--help"]).output
            assert all(f"{option} " in known for option in options if option.startswith("--"))
        written = [options[options.index("--junit") + 1] for options in commands]
        assert self.GITLAB["graphdyn"]["artifacts"]["reports"]["junit"] == written

    def test_the_hooks(self):
        (repository,) = self.PRE_COMMIT["repos"]
        assert [hook["id"] for hook in repository["hooks"]] == list(HOOKS)
