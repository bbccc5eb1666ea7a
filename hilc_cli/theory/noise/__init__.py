"""What disturbances do, to a pass, to learning and to the wheels."""
