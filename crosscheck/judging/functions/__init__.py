"""Functions of motion, momentum and energy as people write them, many codes at once, with faults and slips in them."""
