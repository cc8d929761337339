"""URDF as text, link by link and joint by joint."""


def inertial(mass: float, xyz: str = "0 0 0", rpy: str = "0 0 0", tensor: str = "0.1 0 0 0.1 0 0.1") -> str:
    """tensor: ixx ixy ixz iyy iyz izz."""
    names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    entries = " ".join(f'{name}="{value}"' for name, value in zip(names, tensor.split(), strict=True))
    return f'<inertial><origin xyz="{xyz}" rpy="{rpy}"/><mass value="{mass}"/><inertia {entries}/></inertial>'


def link(name: str, mass: float | None = 1.0, **place_and_tensor: str) -> str:
    return f'<link name="{name}">{"" if mass is None else inertial(mass, **place_and_tensor)}</link>'


def joint(name: str, parent: str, child: str, kind: str = "revolute", more: str = "") -> str:
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{more}</joint>'


def robot_text(name: str, *elements: str) -> str:
    return f'<robot name="{name}">\n' + "\n".join(elements) + "\n</robot>\n"


def with_changes(text: str, *changes: str) -> str:
    """The text with these replacements (old, new, old, new, …), each old text once."""
    for old, new in zip(changes[::2], changes[1::2], strict=True):
        assert old in text
        text = text.replace(old, new, 1)
    return text
