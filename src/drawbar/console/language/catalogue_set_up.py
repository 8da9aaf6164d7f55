"""Catalogue of the set-up page: its texts in English and German, those of calibrations included."""

from collections.abc import Mapping

SET_UP_TEXTS: Mapping[str, tuple[str, str]] = {
    "lengths": ("Lengths", "Längen"),
    "masts": ("Antennas", "Antennen"),
    "limits": ("Speed and limits", "Tempo und Grenzen"),
    "wheelbase": ("Wheelbase", "Radstand"),
    "hitch_length": ("Rear axle to steered joint", "Hinterachse bis Lenkgelenk"),
    "drawbar_length": ("Hitch to steered joint", "Kupplung bis Lenkgelenk"),
    "trailer_length": ("Steered joint to axle", "Lenkgelenk bis Achse"),
    "tracked_point": ("Tracked point before axle", "Geführter Punkt vor Achse"),
    "tractor_mast_forward": ("Tractor, before rear axle", "Traktor, vor Hinterachse"),
    "tractor_mast_left": ("Tractor, left", "Traktor, links"),
    "tractor_mast_up": ("Tractor, up (0: unknown)", "Traktor, hoch (0: offen)"),
    "trailer_mast_forward": ("Trailer, before point", "Anhänger, vor Punkt"),
    "trailer_mast_left": ("Trailer, left", "Anhänger, links"),
    "trailer_mast_up": ("Trailer, up (0: unknown)", "Anhänger, hoch (0: offen)"),
    "driving_speed": ("Driving speed", "Fahrtempo"),
    "smallest_radius": ("Smallest radius of lines", "Kleinster Radius der Linien"),
    "wheels_limit": ("Front wheels, at most", "Vorderräder, höchstens"),
    "joint_limit": ("Steered joint, at most", "Lenkgelenk, höchstens"),
    "wheels_rate": ("Front wheels, fastest", "Vorderräder, Lenktempo"),
    "joint_rate": ("Steered joint, fastest", "Lenkgelenk, Lenktempo"),
    "steering_lag": ("Lag of the steerings", "Verzögerung der Lenkungen"),
    "dead_time": ("Dead time", "Totzeit"),
    "smoothing_limit": ("Lines smoothed by at most", "Linien glätten um höchstens"),
    "drawing_help": (
        "From the side and from above, to scale, front on the right. Touch a letter to change its number.",
        "Von der Seite und von oben, im Maßstab, vorn ist rechts. Buchstaben berühren, um die Zahl zu ändern.",
    ),
    "flaw_greater": ("{name}: must be more than {bound}", "{name}: muss mehr als {bound} sein"),
    "flaw_least": ("{name}: must be at least {bound}", "{name}: muss mindestens {bound} sein"),
    "flaw_less": ("{name}: must be less than {bound}", "{name}: muss weniger als {bound} sein"),
    "flaw_most": ("{name}: must be at most {bound}", "{name}: darf höchstens {bound} sein"),
    "flaw_number": ("{name}: must be a number", "{name}: muss eine Zahl sein"),
    "changes": ("Changes", "Änderungen"),
    "no_changes": ("Nothing is changed.", "Es ist nichts geändert."),
    "save_version": ("Save as a new version", "Als neue Version speichern"),
    "undo": ("Undo", "Rückgängig"),
    "saving_help": (
        "Counts from the next drive on that is started with the new version, not in this one.",
        "Gilt ab der nächsten Fahrt, die mit der neuen Version gestartet wird, noch nicht in dieser.",
    ),
    "only_maintainer": ("Only a maintainer may change this.", "Das darf nur ändern, wer als Wartung angemeldet ist."),
    "versions": ("Versions", "Versionen"),
    "go_on_from": ("Go on from this", "Hiermit weiterarbeiten"),
    "devices": ("Devices: how often they report, how long ago", "Geräte: wie oft gehört, wann zuletzt"),
    "tractor_receiver": ("Tractor's receiver", "Empfänger auf dem Traktor"),
    "trailer_receiver": ("Trailer's receiver", "Empfänger auf dem Anhänger"),
    "hitch_sensor": ("Hitch angle", "Knickwinkel"),
    "wheel_sensor": ("Wheel speed", "Radsensor"),
    "tractor_steering_sensor": ("Angle of front wheels", "Winkel der Vorderräder"),
    "trailer_steering_sensor": ("Angle of steered joint", "Winkel des Lenkgelenks"),
    "controller": ("Controller", "Regler"),
    "gate": ("Gate", "Wächter"),
    # calibration
    "calibrate": ("Calibrate by driving", "Durch Fahren kalibrieren"),
    "calibrate_help": (
        "On a level field, RTK fixed, at walking pace; all by hand, only the last is steered by drawbar. "
        "What is not driven is not found.",
        "Auf ebenem Feld, mit RTK-Fix, im Schritttempo; alles von Hand, nur beim Letzten lenkt drawbar. "
        "Was nicht gefahren wird, wird nicht ermittelt.",
    ),
    "calibrate_straight": (
        "Straight on for 30 m: zeros of all angle sensors, pulses of the wheel sensor",
        "30 m geradeaus: Nullpunkte aller Winkelsensoren, Pulse des Radsensors",
    ),
    "calibrate_left": (
        "Three circles of different sizes to the left; in each hold the steering wheel still for 6 s: scale and "
        "direction of the front wheels' sensor",
        "Drei verschieden große Kreise nach links; in jedem das Lenkrad 6 s lang festhalten: Maßstab und Richtung des "
        "Sensors der Vorderräder",
    ),
    "calibrate_right": ("Three circles to the right, likewise", "Drei Kreise nach rechts, ebenso"),
    "calibrate_back": (
        "Back along the same straight, in the same tracks, 20 s each way: mounting roll of both roll sensors",
        "Auf derselben Geraden zurück, genau in der eigenen Spur, je 20 s: Einbauwinkel beider Rollsensoren",
    ),
    "calibrate_curves": (
        "Two minutes of S-curves, 4 s to each side: where the antenna stands",
        "Zwei Minuten Schlangenlinien, 4 s zu jeder Seite: wo die Antenne sitzt",
    ),
    "calibrate_steered": (
        "Two minutes steered by drawbar along a line with slow curves: dead band, dead time, lag and rate of both "
        "steerings",
        "Zwei Minuten drawbar lenken lassen, auf einer Linie mit sanften Kurven: Totbereich (Lenkspiel), Totzeit, "
        "Verzögerung und Geschwindigkeit beider Lenkungen",
    ),
    "plotted_wheels": ("front wheels, °", "Vorderräder, °"),
    "plotted_joint": ("steered joint, °", "Lenkgelenk, °"),
    "plotted_hitch": ("hitch, °", "Knickwinkel, °"),
    "calibrate_begin": ("● Begin", "● Beginnen"),
    "calibrate_evaluate": ("■ End and evaluate", "■ Beenden und auswerten"),
    "calibrate_keep": ("Save the result", "Ergebnis speichern"),
    "calibrate_drive": ("Drive now.", "Jetzt fahren."),
    "calibrate_found": ("Found: {count}", "Ermittelt: {count}"),
    "calibrate_nothing": (
        "Nothing can be evaluated: driven too briefly, or no devices.",
        "Nichts auszuwerten: zu kurz gefahren, oder keine Geräte.",
    ),
    "only_stand_ins": (
        "The machine is a stand-in: what it shows is not saved.",
        "Die Maschine ist nur nachgebildet: Was sie zeigt, wird nicht gespeichert.",
    ),
    "valve": ("Valve or motor without a loop of its own", "Ventil oder Motor ohne eigene Regelung"),
    "valve_help": (
        "Moves the front wheels by some degrees to both sides, for about three minutes. Letting the switch go ends it, "
        "and so does every STOP; stay on this page.",
        "Bewegt die Vorderräder um einige Grad nach beiden Seiten, etwa drei Minuten lang. Den Schalter loslassen "
        "beendet es, ebenso jedes STOPP; auf dieser Seite bleiben.",
    ),
    "valve_roll": (
        "Roll straight ahead at 3 km/h, 150 m clear, somebody on the seat, the switch held, nobody near the machine",
        "Mit 3 km/h geradeaus rollen, 150 m frei, jemand auf dem Sitz, Schalter gedrückt, niemand nahe der Maschine",
    ),
    "valve_band": (
        "Short pushes, each 1 % harder, until the wheels move: dead band to each side",
        "Kurze Stöße, jeder 1 % stärker, bis sich die Räder bewegen: Totbereich jeder Seite",
    ),
    "valve_rate": (
        "Longer pushes by some degrees: how fast the wheels turn, and how soon",
        "Längere Stöße um einige Grad: wie schnell die Räder drehen, und wie bald",
    ),
    "valve_prepare": ("1 All is clear", "1 Alles ist frei"),
    "valve_begin": ("2 Move now", "2 Jetzt bewegen"),
    "valve_stop": ("■ End", "■ Beenden"),
    "valve_keep": ("Save the sensor's scale", "Maßstab des Sensors speichern"),
    "valve_moves": ("It moves the front wheels.", "Die Vorderräder werden bewegt."),
    "valve_drive": ("drive, %", "Ansteuerung, %"),
    "valve_enter": (
        "Enter dead bands and rates in the settings of drawbar_actuate. The sensor's scale can be saved here.",
        "Totbereiche und Geschwindigkeiten in die Einstellungen von drawbar_actuate eintragen. Der Maßstab des Sensors "
        "lässt sich hier speichern.",
    ),
}
