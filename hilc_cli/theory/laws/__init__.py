"""What is known of each law."""
