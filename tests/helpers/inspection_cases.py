"""A case for every code of urdf.inspect: one change of a robot without a flaw, and the finding to the letter."""

from inspection_of_documents import DOCUMENTS
from inspection_of_joints import JOINTS
from inspection_of_links import LINKS
from inspection_of_refusals import REFUSALS
from inspection_of_robots import ROBOTS

CASES = {**REFUSALS, **DOCUMENTS, **LINKS, **JOINTS, **ROBOTS}
