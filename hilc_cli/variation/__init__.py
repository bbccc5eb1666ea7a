"""What a sweep varies: the values of each key, and the cases that they are put together to."""
