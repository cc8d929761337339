"""`graphdyn identify --rehearse`: what a planned motion will tell, before the robot moves."""
