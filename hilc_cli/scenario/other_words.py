"""What other programs call the keys of a trajectory, and what to write here instead."""

from __future__ import annotations

from collections.abc import Mapping


def _are(meaning: str, *words: str) -> dict[str, str]:
    return dict.fromkeys(words, meaning)


IN_TRAJECTORY: Mapping[str, str] = {
    **_are("it is sample_time", "dt", "timestep"),
    **_are("it is sample_time: 1/(20 Hz) is 50 ms", "samplerate", "samplingrate"),
    **_are("it is closed", "loop", "cyclic"),
    **_are(
        "points go into an entry of segments: '- spline: {points: [[x, y], ...], speed: 0.5}'",
        *("points", "waypoints", "poses", "coordinates"),
    ),
}
OF_POSE: Mapping[str, str] = _are("it is heading", "theta", "yaw", "psi", "phi", "orientation")
OF_TIMING: Mapping[str, str] = {
    **_are("it is speed", "velocity", "maxvelocity", "vmax", "maxspeed"),
    **_are("it is acceleration", "accel", "amax", "maxaccel", "maxacceleration"),
    **_are("it is acceleration, which is that of braking, too", "deceleration", "decel", "braking"),
    **_are("it is lateral_acceleration", "alat", "lateralaccel", "maxlateralacceleration"),
}
OF_SEGMENT: Mapping[str, str] = {
    **_are("it is arc, with 'sweep: 360 deg'", "circle"),
    **_are("it is line", "straight", "move", "drive", "goto"),
    **_are("it is turn", "rotate", "rotation", "spin", "pivot", "turninplace"),
    **_are("it is stop", "pause", "wait", "dwell", "hold", "sleep", "standstill"),
    **_are("it is path, of a file, or spline, of points", "waypoints", "trajectory", "csv"),
    **_are("the kind is a key: '- line: {length: 1, speed: 0.5}'", "type", "kind", "shape"),
}
OF_TIMED: Mapping[str, str] = {
    **_are("it is speed", "velocity", "vel", "v"),
    **_are("it is duration", "time", "t", "seconds"),
}
OF_REVERSIBLE: Mapping[str, str] = {
    **OF_TIMED,
    **_are("it is 'reverse: true'", "backward", "backwards", "back", "direction", "gear"),
}
OF_LINE: Mapping[str, str] = {
    **OF_REVERSIBLE,
    **_are("give the end as 'to: [x, y]'", "x", "y", "end", "target", "goal", "point"),
    **_are("it is length", "distance"),
}
OF_ARC: Mapping[str, str] = {
    **OF_REVERSIBLE,
    **_are("it is turn: left or right", "direction", "side", "ccw", "cw", "clockwise"),
    **_are("it is sweep", "angle", "degrees"),
}
OF_CLOTHOID: Mapping[str, str] = {
    **OF_REVERSIBLE,
    **_are(
        "it turns by its length times the mean of its two curvatures", "sweep", "angle", "degrees"
    ),
}
OF_TURN: Mapping[str, str] = {
    **_are("it is angle, above 0 to the left", "direction", "side", "turn", "sweep", "degrees"),
    **_are("it is rate", "speed", "omega", "yawrate", "angularvelocity", "velocity"),
    **_are("a turn in place goes neither way; give a negative angle to turn right", "reverse"),
}
OF_STOP: Mapping[str, str] = {
    **_are("it is duration", "time", "seconds"),
    **_are("a stop goes neither way; leave it out", "reverse"),
    **_are("a stop has none; leave it out", "speed"),
}
OF_PATH: Mapping[str, str] = {
    **OF_REVERSIBLE,
    **_are("it is file", "filename", "csv", "path", "waypoints", "name"),
    **_are("it is closed", "loop", "cyclic", "lap"),
    **_are("units are told in the header of the file, such as x_mm,y_mm", "unit", "units", "scale"),
    **_are("leave it out: it is found in the file", "delimiter", "separator", "sep", "header"),
    **_are("it is through", "interpolation", "kind", "type", "method"),
}
