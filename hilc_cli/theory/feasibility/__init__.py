"""Whether wheels, tyres and motors can follow the reference."""
