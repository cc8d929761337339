"""Colors of the pictures. On the page each is a variable of page/style.css, so that it follows dark mode."""

INK, SOFT_COLOR, MIDDLE_COLOR, FAINT_COLOR, GROUND, BAR = (
    "#222222",
    "#39424e",
    "#8a8f96",
    "#d9d9d9",
    "#eef0f2",
    "#7d96ad",
)
CURVES = ("#14507f", "#a3161a", "#2f7d32", "#7a5200", "#5b2a86", "#00707a", "#b0487a", "#8b9096")
"""Colors of the curves of a plot and of other marks, in order."""

VARIABLES = {
    INK: "--ink",
    FAINT_COLOR: "--faint",
    MIDDLE_COLOR: "--middle",
    BAR: "--bar",
    SOFT_COLOR: "--soft",
    GROUND: "--ground",
    "#000000": "--ink",
    "#ffffff": "--paper",
    **{color: f"--c{k}" for k, color in enumerate(CURVES)},
}
"""Names in the style sheet."""
