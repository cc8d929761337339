"""The constants of a robot as the recursions take them, and passes that leave fewer of them."""
