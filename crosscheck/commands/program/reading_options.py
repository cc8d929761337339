"""Options that say how a robot is read, the same in every command that reads one."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import typer

if TYPE_CHECKING:
    from urdf import InertialsFromMeshes, Reading, Xacro

FROM_MESHES = "inertials-from-meshes"
"""The repair that has numbers, as urdf.InertialsFromMeshes."""

MimicOption = Annotated[
    Literal["coupled", "independent", "locked"],
    typer.Option(help="Mimic joints follow their joint, are joints of their own, or are locked."),
]


@dataclass(frozen=True, kw_only=True)
class ReadingOptions:
    """The fields of urdf.Reading as options."""

    PANEL: ClassVar[str] = "Reading the robot"

    lock: Annotated[
        list[str] | None,
        typer.Option(metavar="JOINT[=VALUE]", help="Lock a joint at VALUE [rad or m]. Repeatable. [default VALUE: 0]"),
    ] = None
    chain: Annotated[
        tuple[str, str] | None,
        typer.Option(metavar="BASE TIP", help="Use only the arm from link BASE to link TIP; lock other joints at 0."),
    ] = None
    gravity: Annotated[
        tuple[float, float, float] | None,
        typer.Option(metavar="X Y Z", show_default="0 0 -9.81", help="Gravity in world axes [m/s²]."),
    ] = None
    mimic: MimicOption = "coupled"
    loops: Annotated[
        str | None,
        typer.Option(
            metavar="FILE|none",
            show_default="the YAML file beside the URDF",
            help="YAML file with loops that the URDF does not state.",
        ),
    ] = None
    repair: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Repair the file on reading: angles, axis, geoms (MJCF), inertials, limits, or "
            f"{FROM_MESHES}=DENSITY [kg/m³] or =MASSkg, then ,all or ,LINK,… for other links than those without "
            "<inertial>. Repeatable.",
        ),
    ] = None
    xacro: Annotated[
        list[str] | None, typer.Option(metavar="NAME=VALUE", help="Argument of a .xacro file. Repeatable.")
    ] = None
    xacro_package: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=FOLDER", help="Folder of a package that a .xacro file names. Repeatable."),
    ] = None

    @property
    def reading(self) -> Reading:
        """Raises typer.BadParameter for a text of another form; urdf.load refuses what no robot has."""
        from urdf import Reading

        return Reading(
            lock=dict(map(_locked, self.lock or ())) or None,
            chain=self.chain,
            gravity=self.gravity,
            mimic=self.mimic,
            loops=() if self.loops == "none" else None if self.loops is None else Path(self.loops),
            repair=[repair_of("--repair", text) for text in self.repair or ()],
            xacro=self._xacro,
        )

    @property
    def _xacro(self) -> Xacro | None:
        from urdf import Xacro

        if not self.xacro and not self.xacro_package:
            return None
        return Xacro(
            dict(pairs("--xacro", self.xacro, "NAME=VALUE")),
            dict(pairs("--xacro-package", self.xacro_package, "NAME=FOLDER")),
        )


def reading_arguments(options: ReadingOptions) -> list[str]:
    """The arguments with which a robot is read in the same way by another command."""
    arguments: list[str] = []
    for each in fields(ReadingOptions):
        value, option = getattr(options, each.name), f"--{each.name.replace('_', '-')}"
        if value == each.default:
            continue
        if isinstance(value, list):
            arguments += [part for one in value for part in (option, one)]
        else:
            arguments += [option, *map(str, value if isinstance(value, tuple) else (value,))]
    return arguments


def refuse_for_several(reading: Reading) -> None:
    """Raises typer.BadParameter where several robots are to be read by options that belong to one."""
    if reading.lock or reading.chain:
        raise typer.BadParameter("--lock and --chain need exactly one robot, whose joints and links they name")
    if reading.loops or reading.xacro:
        raise typer.BadParameter("--loops and --xacro need exactly one robot, to whose file they belong")


def pairs(option: str, texts: list[str] | None, form: str) -> list[tuple[str, str]]:
    """NAME=VALUE of a repeatable option. Raises typer.BadParameter for another form, and a name given twice."""
    found: dict[str, str] = {}
    for text in texts or ():
        name, equals, value = text.partition("=")
        if not (name and equals and value):
            raise typer.BadParameter(f"{option} {text}: give {form}")
        if name in found:
            raise typer.BadParameter(f"{option} {text}: {name} is given twice")
        found[name] = value
    return list(found.items())


def _locked(text: str) -> tuple[str, float]:
    from urdf.document import finite_number

    name, _, value = text.partition("=")
    position = finite_number(value or "0")
    if position is None:
        raise typer.BadParameter(f"--lock {text}: '{value}' is not a number")
    return name, position


def repair_of(option: str, text: str) -> str | InertialsFromMeshes:
    """A repair as it is typed. Raises typer.BadParameter for numbers of another form."""
    from urdf import InertialsFromMeshes
    from urdf.document import finite_number

    name, _, value = text.partition("=")
    if name != FROM_MESHES:
        return text
    size, *links = value.split(",")
    number = finite_number(size.removesuffix("kg"))
    if number is None:
        raise typer.BadParameter(
            f"{option} {text}: give {FROM_MESHES}=2700 for a density [kg/m³], or {FROM_MESHES}=20kg for a total mass"
        )
    chosen = "all" if links == ["all"] else links or "missing"
    if size.endswith("kg"):
        return InertialsFromMeshes(total_mass=number, links=chosen)
    return InertialsFromMeshes(density=number, links=chosen)
