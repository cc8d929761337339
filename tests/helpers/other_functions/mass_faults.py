"""Mistakes in centers of mass, momentum and energies."""

# ruff: noqa: E501 - one case a line

import xml.etree.ElementTree as ElementTree

import numpy as np
from other_functions.fault import answers, arguments, numbers, path_of, plant, text
from other_functions.torque_faults import OPPOSITE, OUT, TOOL, tool

TOOLED = ("ur5", "kinova", "panda", "kr210_r2700_2")
BASED = {"ur5": "base_link", "ur3": "base_link", "panda": "panda_link0", "xarm7": "link_base", "so100": "base"}
BODY_3 = f"(mass|body|link).*<body 3>.*{OUT}"
FACTOR = "all answers are multiplied"
"""What a wrong total mass does."""

TURNED = "(not turned|world axes|link axes|rotation|Rᵀ|wrong way|transposed)"


def base_of(robot):
    """Mass and center of mass of the base link, which stands still."""
    link = next(x for x in ElementTree.parse(path_of(robot)).iter("link") if x.get("name") == BASED[robot])
    origin = link.find("inertial/origin")
    center = [0.0, 0.0, 0.0] if origin is None else [float(x) for x in origin.get("xyz", "0 0 0").split()]
    return float(link.find("inertial/mass").get("value")), np.array(center)


def with_base(robot, function):
    """Averages over the base link as well."""

    def planted(arm, right, code):
        mass, center = base_of(robot)
        total = arm.masses.sum()
        own = 0 if function != "center_of_mass" else mass * center
        return lambda *x: (total * right(*x) + own) / (total + mass)

    words = "base|fixed link|still|total mass|sum of the masses"
    equal = FACTOR if function == "center_of_mass_jacobian" else ""
    return plant(function, f"base of the {robot} counted", planted, words, equal=equal, robots=(robot,))


COM = (
    text("center_of_mass", "a body missing above", "center_of_mass", "return sum(arm.masses[j] * c[j]", "return sum((j != 2) * arm.masses[j] * c[j]", f"<body 3>.*{OUT}|<body 3>.*(numerator|sum)"),
    numbers("center_of_mass", "a body missing", lambda arm: arm.one("masses", 2, lambda m: 0 * m), BODY_3 + "|mass.*<body 3>"),
    text("center_of_mass", "a body missing below", "center_of_mass", "total = sum(arm.masses[j] ", "total = sum((j != 1) * arm.masses[j] ", f"<body 2>.*{OUT}|<body 2>.*(denominator|total)|total mass|divided", equal=FACTOR),
    with_base("ur5", "center_of_mass"),
    with_base("panda", "center_of_mass"),
    numbers("center_of_mass", "mean of the centers", lambda arm: arm.but(masses=np.ones(arm.n)), "(mass|weight).*(equal|1 kg|same|one|not|unweighted)|mean"),
    numbers("center_of_mass", "of the link origins", lambda arm: arm.but(centers=0 * arm.centers), f"(center|\\bc\\b|inertial).*({OUT}|link origin)"),
    text("center_of_mass", "centers not turned", "body_centers", "R[j + 1] @ arm.centers[j]", "arm.centers[j]", "(center|\\bc\\b).*" + TURNED),
    text("center_of_mass", "centers turned back", "body_centers", "R[j + 1] @ arm.centers[j]", "R[j + 1].T @ arm.centers[j]", "(center|\\bc\\b).*" + TURNED),
    numbers("center_of_mass", "tool", tool, TOOL, robots=TOOLED),
    numbers("center_of_mass", "center of one body of another variant", lambda arm: arm.one("centers", 1, lambda c: np.add(c, [0.02, -0.01, 0.03])), "center.*<body 2>|<body 2>.*center"),
    numbers("center_of_mass", "centers shifted by one body", lambda arm: arm.but(centers=np.roll(arm.centers, 1, axis=0)), "center.*(shift|next|another|other bod|order|exchang|before)"),
    text("center_of_mass_jacobian", "divided by the mass without the first link", "center_of_mass_jacobian", "np.sum(arm.masses)", "np.sum(arm.masses[1:])", "(mass|divided|factor|multiplied|× 1)"),
    with_base("xarm7", "center_of_mass_jacobian"),
    text("center_of_mass_jacobian", "of the link origins", "center_of_mass_jacobian", "body_centers(arm, q)", "poses(arm, q)[1][1:]", f"(center|\\bc\\b).*({OUT}|link origin)"),
    text("center_of_mass_jacobian", "not divided by the mass", "center_of_mass_jacobian", "return J / np.sum(arm.masses)", "return J", "(mass|divided|factor|multiplied)"),
    text("center_of_mass_jacobian", "all masses move with every joint", "center_of_mass_jacobian", "for j in range(arm.n):\n        J += arm.masses[j] * point_jacobian(arm, q, j + 1, c[j])[:3]", "total = sum(arm.masses[j] * c[j] for j in range(arm.n))\n    J = point_jacobian(arm, q, arm.n, total / np.sum(arm.masses))[:3] * np.sum(arm.masses)", "(all|every|whole|total|inside|outer).*(mass|bod|center)|(mass|bod).*(all|every|whole|inside)", robots=("ur5", "kinova", "z1", "xarm7", "kr210_r2700_2")),
    text("center_of_mass_jacobian", "a body missing", "center_of_mass_jacobian", "J += arm", "J += (j != 2) * arm", f"<body 3>.*{OUT}"),
    numbers("center_of_mass_jacobian", "mass of another variant", lambda arm: arm.one("masses", 1, lambda m: 1.1 * m), "mass.*<body 2>"),
    arguments("center_of_mass_jacobian", "zero of a joint", lambda q: (q + 0.5 * np.pi * (np.arange(len(q)) == 1),), "(zero|position).*<joint 2>|<joint 2>.*(90|1\\.57|zero|turned)"),
    text("center_of_mass_velocity", "not divided by the mass", "center_of_mass_velocity", " / np.sum(arm.masses)", "", "(mass|divided|factor|multiplied|momentum)"),
    text("center_of_mass_velocity", "of the link origins", "center_velocities", " + cross(w[j + 1], R[j + 1] @ arm.centers[j])", "", f"(center|ω × c).*({OUT}|link origin)"),
    text("center_of_mass_velocity", "c not turned", "center_velocities", "R[j + 1] @ arm.centers[j]", "arm.centers[j]", "(center|\\bc\\b).*" + TURNED),
    text("center_of_mass_velocity", "ω × c with the inside ω", "center_velocities", "cross(w[j + 1], R", "cross(w[arm.inside[j]], R", "(ω × c|ω).*inside"),
    text("center_of_mass_velocity", "a body missing", "center_of_mass_velocity", "return sum(arm.masses[j] ", "return sum((j != 2) * arm.masses[j] ", f"<body 3>.*{OUT}"),
    arguments("center_of_mass_velocity", "one joint in degrees per second", lambda q, v: (q, v * np.where(np.arange(len(v)) == 2, 180 / np.pi, 1)), "<joint 3>.*(degree|57\\.29|180)|(degree|57\\.29).*<joint 3>"),
)  # fmt: skip

MOMENTUM = (
    text("momentum", "no spin", "momentum", "I @ w[j + 1] + ", "", f"(tensor|spin|J ω|I ω|inertia).*{OUT}"),
    text("momentum", "tensor not turned", "momentum", "R[j + 1] @ arm.tensors[j] @ R[j + 1].T", "arm.tensors[j]", "(tensor|J in|\\bJ\\b|inertia).*" + TURNED),
    text("momentum", "tensor turned the wrong way", "momentum", "R[j + 1] @ arm.tensors[j] @ R[j + 1].T", "R[j + 1].T @ arm.tensors[j] @ R[j + 1]", "(tensor|J in|\\bJ\\b|inertia).*" + TURNED),
    text("momentum", "p × (c - com)", "momentum", "cross(c[j] - com, p)", "cross(p, c[j] - com)", f"(angular|c ×|r ×|lever|moment of).*{OPPOSITE}"),
    text("momentum", "about the origin of the first link", "momentum", "center_of_mass(arm, q)", "poses(arm, q)[1][1]", "(about|point|origin|link origin|center of mass)", robots=("ur5", "xarm7", "kr210_r2700_2", "panda")),
    text("momentum", "half the spin", "momentum", "I @ w[j + 1] + ", "0.5 * I @ w[j + 1] + ", "(tensor|spin|J ω|I ω|inertia).*(0\\.5|half|halved)"),
    text("momentum", "spin with the inside ω", "momentum", "I @ w[j + 1]", "I @ w[arm.inside[j]]", "(ω|spin|angular velocity).*inside|J ω.*inside"),
    numbers("momentum", "a body missing", lambda arm: arm.one("masses", 1, lambda m: 0 * m).one("tensors", 1, lambda J: 0 * J), f"<body 2>.*{OUT}|(mass|tensor).*<body 2>"),
    numbers("momentum", "a length", lambda arm: arm.one("translations", 2, lambda r: np.add(1.1 * r, [0.01, 0, 0])), "(translation|place|length|origin).*<joint 3>"),
    numbers("momentum", "tensor of another variant", lambda arm: arm.one("tensors", 2, lambda J: J + np.diag([0.02, 0.01, 0.02])), "(tensor|inertia|I_..).*<body 3>|<body 3>.*(tensor|inertia)"),
    text("centroidal_map", "half the spin", "centroidal_map", "A[3:, k] += I @ J[3:, k]", "A[3:, k] += 0.5 * I @ J[3:, k]", "(tensor|spin|J ω|I ω|inertia|J_ω).*(0\\.5|half|halved)"),
    text("centroidal_map", "tensor not turned", "centroidal_map", "R[j + 1] @ arm.tensors[j] @ R[j + 1].T", "arm.tensors[j]", "(tensor|J in|\\bJ\\b|inertia).*" + TURNED),
    text("centroidal_map", "levers of the link origins", "centroidal_map", "cross(c[j] - com, p)", "cross(poses(arm, q)[1][j + 1] - com, p)", "(lever|center|c |link origin)"),
    text("centroidal_map", "lever missing", "centroidal_map", " + cross(c[j] - com, p)", "", f"(lever|c ×|r ×|moment of).*{OUT}"),
    answers("centroidal_map", "transposed blocks: angular rows of the other sign", lambda A, q: A * np.where(np.arange(6) < 3, 1, -1)[:, None], f"(angular).*{OPPOSITE}|angular part (by|is multiplied by) -1"),
    numbers("centroidal_map", "bodies exchanged", lambda arm: arm.but(masses=arm.masses[[0, 2, 1, *range(3, arm.n)]], centers=arm.centers[[0, 2, 1, *range(3, arm.n)]], tensors=arm.tensors[[0, 2, 1, *range(3, arm.n)]]), "(<body 2>.*<body 3>|<body 3>.*<body 2>).*exchang|exchang.*<body [23]>"),
    answers("centroidal_map", "per unit of mass", lambda A, q: A / 10, "(0\\.1|mass|factor|10)"),
)  # fmt: skip

ENERGY = (
    answers("kinetic_energy", "½ forgotten", lambda T, *_: 2 * T, "(2|½|twice|doubl)"),
    text("kinetic_energy", "½ forgotten in the rotation", "kinetic_energy", "0.5 * spin", "spin", "(rotation|tensor|ω|spin|inertia|J).*(2|½|twice|doubl)"),
    text("kinetic_energy", "no rotation", "kinetic_energy", "0.5 * spin", "0 * spin", f"(rotation|tensor|ω|spin|inertia|J).*{OUT}|point mass"),
    text("kinetic_energy", "ω in world axes on a tensor in link axes", "kinetic_energy", "R[j + 1].T @ w[j + 1]", "w[j + 1]", "(tensor|ω|J|inertia|spin).*" + TURNED),
    numbers("kinetic_energy", "tensors about the link origins", lambda arm: arm.but(tensors=arm.tensors + np.array([m * (c @ c * np.eye(3) - np.outer(c, c)) for m, c in zip(arm.masses, arm.centers, strict=True)])), "link origin"),
    text("kinetic_energy", "velocities of the link origins", "center_velocities", " + cross(w[j + 1], R[j + 1] @ arm.centers[j])", "", f"(center|ω × c|inertial frame).*({OUT}|link origin)"),
    numbers("kinetic_energy", "a body missing", lambda arm: arm.one("masses", 2, lambda m: 0 * m).one("tensors", 2, lambda J: 0 * J), f"<body 3>.*{OUT}|(mass|tensor).*<body 3>", equal=f"I a at joint '<joint 3>'.*{OUT}"),
    numbers("kinetic_energy", "products of inertia of the other sign", lambda arm: arm.but(tensors=arm.tensors * (2 * np.eye(3) - 1)), f"products? of inertia.*{OPPOSITE}"),
    numbers("kinetic_energy", "I_xx and I_zz exchanged", lambda arm: arm.one("tensors", 1, lambda J: J[::-1, ::-1]), "(tensor|I_xx|I_zz|inertia).*<body 2>|<body 2>.*(tensor|I_xx|inertia)"),
    text("kinetic_energy", "drives added", "kinetic_energy", "energy = 0.0", "energy = 0.01 * v @ v", "(drive|rotor|armature|diagonal|proportional to v)"),
    arguments("kinetic_energy", "joint turned the other way", lambda q, v: (q, v * np.where(np.arange(len(v)) == 1, -1, 1)), f"<joint 2>.*{OPPOSITE}|{OPPOSITE}.*<joint 2>"),
    answers("potential_energy", "sign", lambda U, q: -U, f"(gravity|energy|result|answer).*{OPPOSITE}"),
    text("potential_energy", "heights of the link origins", "potential_energy", "body_centers(arm, q)", "poses(arm, q)[1][1:]", f"(center|\\bc\\b).*({OUT}|link origin)"),
    text("potential_energy", "a body missing", "potential_energy", "energy -= arm", "energy -= (j != 2) * arm", f"(mass|weight|body|link).*<body 3>.*{OUT}|<body 3>.*{OUT}"),
    numbers("potential_energy", "g = 9.7", lambda arm: arm.but(gravity=arm.gravity / np.linalg.norm(arm.gravity) * 9.7), "gravity.*(9\\.7|0\\.98)|(9\\.7|0\\.98\\d+).*gravity", equal="(weight|mass|result|answer|energ).*0\\.98"),
    numbers("potential_energy", "y is up", lambda arm: arm.but(gravity=np.roll(arm.gravity, -1)), "gravity.*(y|along|\\(0, -|other direction)"),
    text("potential_energy", "centers not turned", "body_centers", "R[j + 1] @ arm.centers[j]", "arm.centers[j]", "(center|\\bc\\b).*" + TURNED),
    text("potential_energy", "g forgotten", "potential_energy", "arm.gravity @ c[j]", "np.array([0, 0, -1.0]) @ c[j]", "gravity|0\\.10[12]|divided by g"),
)  # fmt: skip

FAULTS = (*COM, *MOMENTUM, *ENERGY)
