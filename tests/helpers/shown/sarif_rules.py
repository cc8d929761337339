"""What code scanning needs of a SARIF file: the part of the standard's schema that graphdyn writes, nothing else."""

from jsonschema import Draft7Validator


def _object(**properties):
    """All of them are needed, but for those in brackets; no others."""
    needed = [name for name, value in properties.items() if not isinstance(value, tuple)]
    known = {name: value[0] if isinstance(value, tuple) else value for name, value in properties.items()}
    return {"type": "object", "properties": known, "required": needed, "additionalProperties": False}


TEXT = {"type": "string", "minLength": 1}
LEVEL = {"enum": ["error", "warning", "note"]}
MESSAGE = _object(text=TEXT)
RULE = _object(
    id=TEXT,
    shortDescription=MESSAGE,
    help=MESSAGE,
    helpUri={"type": "string", "pattern": "^https://"},
    defaultConfiguration=_object(level=LEVEL),
)
LOCATION = _object(
    physicalLocation=_object(
        artifactLocation=_object(uri={"type": "string", "pattern": "^(?!/)[^ <>]+$"}),
        region=_object(startLine={"type": "integer", "minimum": 1}),
    ),
    logicalLocations=({"type": "array", "items": _object(fullyQualifiedName=TEXT)},),
)
RESULT = _object(
    ruleId=TEXT,
    ruleIndex={"type": "integer", "minimum": 0},
    level=LEVEL,
    message=MESSAGE,
    locations={"type": "array", "items": LOCATION, "minItems": 1, "maxItems": 1},
    partialFingerprints=_object(**{"graphdyn/v1": {"type": "string", "pattern": "^[0-9a-f]{16}:[1-9][0-9]*$"}}),
    baselineState=({"enum": ["new", "unchanged"]},),
)
DRIVER = _object(
    name={"const": "graphdyn"},
    version=TEXT,
    informationUri=TEXT,
    rules={"type": "array", "items": RULE, "uniqueItems": True},
)
RUN = _object(
    tool=_object(driver=DRIVER),
    automationDetails=_object(id={"type": "string", "pattern": "^graphdyn-[a-z]+/$"}),
    columnKind={"enum": ["utf16CodeUnits", "unicodeCodePoints"]},
    results={"type": "array", "items": RESULT},
)
LOG = _object(
    **{"$schema": TEXT, "version": {"const": "2.1.0"}, "runs": {"type": "array", "items": RUN, "minItems": 1}}
)


def results_of(document):
    """The results of a SARIF file, which keeps to the rules."""
    Draft7Validator(LOG).validate(document)
    (run,) = document["runs"]
    for result in run["results"]:
        assert run["tool"]["driver"]["rules"][result["ruleIndex"]]["id"] == result["ruleId"]
    prints = [result["partialFingerprints"]["graphdyn/v1"] for result in run["results"]]
    assert len(set(prints)) == len(prints)
    return run["results"]
