"""Signal words: what people call the signals of a control step, in English and German, with the unit.

A signal is called by what it is, of which body, and where it comes from: `measurement.tractor_x` is "East · tractor ·
measured (m)".
"""

from collections.abc import Mapping

BODIES: Mapping[str, tuple[str, str]] = {"tractor": ("tractor", "Traktor"), "trailer": ("trailer", "Anhänger")}
"""by the beginning of a name"""
SECTIONS: Mapping[str, tuple[str, str]] = {
    "measurement": ("measured", "gemessen"),
    "estimate": ("estimated", "geschätzt"),
    "reference": ("", ""),
    "plan": ("planned", "geplant"),
    "command": ("commanded", "befohlen"),
    "truth": ("true", "wahr"),
    "steering": ("", ""),
    "times": ("controller", "Regler"),
    "estimator_times": ("estimator", "Schätzer"),
    "actuation": ("planned with", "womit geplant wird"),
    "actuation.": ("as it shows", "wie es sich zeigt"),
    "controller": ("", ""),
}
"""by what comes before the first dot; with a dot: where a body comes after it"""
QUANTITIES: Mapping[str, tuple[str, str, str]] = {
    "step": ("Step", "Schritt", ""),
    "time": ("Time", "Zeit", "s"),
    "x": ("East", "Osten", "m"),
    "y": ("North", "Norden", "m"),
    "yaw": ("Direction, from east to the left", "Richtung, von Osten nach links", "rad"),
    "height": ("Height", "Höhe", "m"),
    "speed": ("Speed", "Tempo", "m/s"),
    "hitch_angle": ("Hitch angle", "Knickwinkel", "rad"),
    "steering": ("Steering angle", "Lenkwinkel", "rad"),
    "roll": ("Roll, right side down", "Wanken, rechts tief", "rad"),
    "pitch": ("Pitch, nose up", "Nicken, vorn hoch", "rad"),
    "roll_offset": (
        "Roll shown while level, beyond what is stated",
        "Wanken im Lot, über das Angegebene hinaus",
        "rad",
    ),
    "roll_deviation": ("Uncertainty of that roll", "Unsicherheit dieses Wankens", "rad"),
    "yaw_rate": ("Yaw rate", "Drehrate", "rad/s"),
    "fix_deviation": ("Uncertainty of the fix", "Unsicherheit der Position", "m"),
    "fix_quality": ("Quality of the fix, 5 is RTK fixed", "Güte der Position, 5 ist RTK Fix", ""),
    "fix_age": ("Age of the fix", "Alter der Position", "s"),
    "fix_latency": ("Unreported latency of the fixes", "Nicht gemeldeter Verzug der Positionen", "s"),
    "hitch_latency": ("Unreported latency of the hitch angle", "Nicht gemeldeter Verzug des Knickwinkels", "s"),
    "hitch_scale": ("True per measured hitch angle, less 1", "Wahrer je gemessener Knickwinkel, weniger 1", "1"),
    "joint_scale": (
        "True per measured angle of the joint, less 1",
        "Wahrer je gemessener Gelenkwinkel, weniger 1",
        "1",
    ),
    "body_lag": ("Lag of the body behind its wheels", "Nachlauf des Rumpfs hinter den Rädern", "s"),
    "body_lag_deviation": ("Uncertainty of that lag", "Unsicherheit dieses Nachlaufs", "s"),
    "fix": ("What became of the fix, 0 is used", "Was aus der Position wurde, 0: genutzt", ""),
    "hitch_angle_age": ("Age of the hitch angle", "Alter des Knickwinkels", "s"),
    "speed_age": ("Age of the speed", "Alter des Tempos", "s"),
    "steering_age": ("Age of the steering angle", "Alter des Lenkwinkels", "s"),
    "attitude_age": ("Age of roll, pitch and yaw rate", "Alter von Wanken, Nicken, Drehrate", "s"),
    "longitudinal_slip": ("Slip along, 1 is none", "Schlupf längs, 1 ist keiner", "1"),
    "slip": ("Slip across, 1 is none", "Schlupf quer, 1 ist keiner", "1"),
    "steering_offset": ("Steering offset", "Lenkversatz", "rad"),
    "crab": ("Side slip", "Schräglauf", "rad"),
    "slide_east": ("Side slip by the slope, to the east", "Schräglauf vom Hang, nach Osten", "rad"),
    "slide_north": ("Side slip by the slope, to the north", "Schräglauf vom Hang, nach Norden", "rad"),
    "creep": ("Side slip per side acceleration of a curve", "Schräglauf je Querbeschleunigung der Kurve", "rad/g"),
    "progress": ("Way along the line", "Weg entlang der Linie", "m"),
    "lateral_error": ("Left of the line", "Links der Linie", "m"),
    "closest.0": ("Nearest point of the line, east", "Nächster Punkt der Linie, Osten", "m"),
    "closest.1": ("Nearest point of the line, north", "Nächster Punkt der Linie, Norden", "m"),
    "closest.2": ("Direction of the line", "Richtung der Linie", "rad"),
    "line_x": ("Nearest point of the tool's line, east", "Nächster Punkt der Linie des Werkzeugs, Osten", "m"),
    "line_y": ("Nearest point of the tool's line, north", "Nächster Punkt der Linie des Werkzeugs, Norden", "m"),
    "closest.3": ("Curvature of the line", "Krümmung der Linie", "1/m"),
    "deviation.0": ("Off the plan, error 1", "Neben dem Plan, Fehler 1", ""),
    "deviation.1": ("Off the plan, error 2", "Neben dem Plan, Fehler 2", ""),
    "deviation.2": ("Off the plan, error 3", "Neben dem Plan, Fehler 3", ""),
    "nominal": ("Steering of the plan", "Lenkwinkel des Plans", "rad"),
    "ancillary": ("Steering against deviations", "Lenkwinkel gegen Abweichungen", "rad"),
    "command": ("Steering, both together", "Lenkwinkel, beides zusammen", "rad"),
    "margin": ("Margin in the tube, 0 is its edge", "Abstand zum Rand des Schlauchs, 0 am Rand", "1"),
    "saturated": ("Steering at its limit, 1 is yes", "Lenkung am Anschlag, 1 ist ja", ""),
    "prepare": ("Time to prepare", "Zeit zum Vorbereiten", "s"),
    "feedback": ("Time to answer", "Zeit zum Antworten", "s"),
    "dead_time": ("Dead time", "Totzeit", "s"),
    "dead_time_deviation": ("Uncertainty of the dead time", "Unsicherheit der Totzeit", "s"),
    "lag": ("Lag", "Verzögerung", "s"),
    "lag_deviation": ("Uncertainty of the lag", "Unsicherheit der Verzögerung", "s"),
    "rate": ("Largest steering rate", "Höchste Lenkgeschwindigkeit", "rad/s"),
    "rate_deviation": ("Uncertainty of that rate", "Unsicherheit dieser Geschwindigkeit", "rad/s"),
    "solver_failures": ("Solver failures in this step", "Rechnungen ohne Lösung in diesem Schritt", ""),
    "gate": ("What was made of the command, 0 is passed", "Was aus dem Befehl wurde, 0: weitergegeben", ""),
    "status": ("Status, 0 is well", "Status, 0 ist gut", ""),
    "flags": ("Flags, 0 is none", "Hinweise, 0 ist keiner", ""),
    "lateral_deviation": ("Uncertainty across the line", "Unsicherheit quer zur Linie", "m"),
    "heading_deviation": ("Uncertainty of the direction", "Unsicherheit der Richtung", "rad"),
    "correction_age": ("Age of the corrections", "Alter der Korrekturen", "s"),
    "solved": ("Steps solved in a row", "Gelöste Schritte in Folge", ""),
    "overruns": ("Late steps", "Späte Schritte", ""),
}
"""by the rest, with the unit"""


def signal_words(name: str, language: int) -> str:
    """Return what a signal is called; language: 0 English, 1 German. A signal without words is called by its name."""
    section, _, rest = name.rpartition(".") if "." not in name else name.partition(".")
    first, section = _body(section)
    second, quantity = _body(rest)
    if quantity not in QUANTITIES or section not in {"", *SECTIONS}:
        return name
    body = BODIES.get(first or second, ("", ""))[language]
    nested = f"{section}." if rest.startswith(f"{second}.") else section
    source = SECTIONS.get(nested, SECTIONS.get(section, ("", "")))[language]
    unit = QUANTITIES[quantity][2]
    return " · ".join(filter(None, (QUANTITIES[quantity][language], body, source))) + (f" ({unit})" if unit else "")


def _body(name: str) -> tuple[str, str]:
    """Return which body a name begins with, and the rest."""
    for body in BODIES:
        if name[: len(body) + 1] in (f"{body}_", f"{body}."):
            return body, name[len(body) + 1 :]
    return "", name
