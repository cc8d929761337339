"""A case for every code of urdf.inspect: one change of a robot without a flaw, and the finding to the letter."""

from inspected.of_documents import DOCUMENTS
from inspected.of_joints import JOINTS
from inspected.of_links import LINKS
from inspected.of_refusals import REFUSALS
from inspected.of_robots import ROBOTS

CASES = {**REFUSALS, **DOCUMENTS, **LINKS, **JOINTS, **ROBOTS}
