"""Catalogue: every text of the pages in English and German, in one place; the causes' German is in causes_de.py."""

from collections.abc import Mapping
from typing import Literal

from drawbar.console.causes_de import CAUSES_DE
from drawbar.safety.causes import Cause

Language = Literal["en", "de"]

TEXTS: Mapping[str, tuple[str, str]] = {
    # states: a word, and what it means
    "BOOT": ("Starting", "Startet"),
    "SELFTEST": ("Testing itself", "Prüft sich"),
    "STANDBY": ("Not ready", "Nicht bereit"),
    "READY": ("Ready", "Bereit"),
    "ENGAGING": ("Taking over", "Übernimmt"),
    "ACTIVE": ("Steering", "Lenkt"),
    "DEGRADED": ("Steering, slower", "Lenkt, langsamer"),
    "STOPPING": ("Stopping", "Hält an"),
    "STOPPED": ("Stopped", "Angehalten"),
    "OVERRIDE": ("You took over", "Sie lenken selbst"),
    "FAULT": ("Let go: fault", "Losgelassen: Störung"),
    "ESTOP": ("Emergency stop", "Not-Halt"),
    "NO_CONTACT": ("No contact", "Kein Kontakt"),
    "no_contact_why": (
        "The autopilot's gate is not heard. What is shown is old. Steer and brake yourself.",
        "Der Autopilot meldet sich nicht. Die Anzeige ist alt. Selbst lenken und bremsen.",
    ),
    "seconds_left": ("{seconds} s left", "noch {seconds} s"),
    "stop_vehicle": ("Brake: stop the vehicle now", "Bremsen: Fahrzeug jetzt anhalten"),
    # why not
    "why_not": ("To do before it can engage", "Vor dem Einschalten zu tun"),
    "next": ("What to do next", "Was jetzt zu tun ist"),
    "next_ready": (
        "Press 1 Prepare, then within five seconds 2 Engage.",
        "1 Vorbereiten drücken, dann innerhalb von fünf Sekunden 2 Einschalten.",
    ),
    "worries": ("Attention while driving", "Achtung während der Fahrt"),
    "because": ("Because: {cause}", "Grund: {cause}"),
    "wait_ready": ("All is well; wait two seconds.", "Alles in Ordnung; zwei Sekunden warten."),
    # controls
    "arm": ("1 Prepare", "1 Vorbereiten"),
    "engage": ("2 Engage", "2 Einschalten"),
    "acknowledge": ("Acknowledge", "Bestätigen"),
    "stop": ("STOP", "STOPP"),
    "release": ("Let go", "Loslassen"),
    "emergency": ("EMERGENCY", "NOT-HALT"),
    "slower": ("Slower", "Langsamer"),
    "faster": ("Faster", "Schneller"),
    "nudge_left": ("Line 2 cm to the left", "Linie 2 cm nach links"),
    "nudge_right": ("Line 2 cm to the right", "Linie 2 cm nach rechts"),
    "set_speed": ("Set speed", "Soll-Tempo"),
    "pass_left": ("Next line to the left", "Nächste Linie links"),
    "pass_right": ("Next line to the right", "Nächste Linie rechts"),
    "not_drivable": ("✖ not drivable", "✖ nicht fahrbar"),
    "line_shift": ("Line", "Linie"),
    # lease
    "you_control": ("You have control", "Sie steuern"),
    "nobody_controls": ("Nobody has control", "Niemand steuert"),
    "other_controls": ("{name} has control", "{name} steuert"),
    "somebody": ("Another front end", "Ein anderes Bediengerät"),
    "operator_name": ("Operator {name}", "Bediener {name}"),
    "ask_control": ("Ask for control", "Steuerung erbitten"),
    "asked_control": ("Asked for control; wait for the answer", "Steuerung erbeten; auf Antwort warten"),
    "wishes_control": ("{name} asks for control", "{name} bittet um die Steuerung"),
    "give_control": ("Give control", "Steuerung abgeben"),
    "stop_first": ("Stop first, then give control", "Zuerst anhalten, dann abgeben"),
    "only_viewer": ("You may look and stop", "Sie dürfen zusehen und anhalten"),
    # answers
    "refused": ("Not done: {cause}. {advice}", "Nicht ausgeführt: {cause}. {advice}"),
    "no_answer": ("No answer from the autopilot: look at the state", "Keine Antwort vom Autopiloten: Zustand ansehen"),
    "too_often": ("Too many commands: wait a moment", "Zu viele Befehle: kurz warten"),
    # figures
    "tractor": ("Tractor", "Traktor"),
    "trailer": ("Trailer", "Anhänger"),
    "left": ("left of the line", "links der Linie"),
    "right": ("right of the line", "rechts der Linie"),
    "on_line": ("on the line", "auf der Linie"),
    "not_known": ("not known", "unbekannt"),
    "speed": ("Speed", "Tempo"),
    "fix": ("Position", "Position"),
    "corrections": ("Corrections", "Korrekturen"),
    "fix_UNKNOWN": ("unknown", "unbekannt"),
    "fix_NONE": ("none", "keine"),
    "fix_SINGLE": ("metres", "Meter"),
    "fix_DIFFERENTIAL": ("decimetres", "Dezimeter"),
    "fix_FLOAT": ("RTK float", "RTK Float"),
    "fix_FIXED": ("RTK fixed", "RTK Fix"),
    "old": ("OLD PICTURE – steer yourself", "ALTES BILD – selbst lenken"),
    "map": ("Map: field, lines, tractor, trailer and plan", "Karte: Feld, Linien, Traktor, Anhänger und Plan"),
    "zoom_in": ("Closer", "Näher"),
    "zoom_out": ("Farther", "Weiter"),
    "whole": ("Whole line", "Ganze Linie"),
    # pages
    "drive": ("Drive", "Fahren"),
    "fields": ("Fields and lines", "Felder und Linien"),
    "setup": ("Set-up", "Einrichten"),
    "runs": ("Runs", "Fahrten"),
    "inside": ("Look inside", "Einblick"),
    "saved_for_next": (
        "Saved. For the next drive: drawbar drive {file}",
        "Gespeichert. Für die nächste Fahrt: drawbar drive {file}",
    ),
    "number_missing": ("a number is missing", "eine Zahl fehlt"),
    # fields
    "field_map": ("Map: boundary, lines, chosen pass, tractor", "Karte: Grenze, Linien, gewählte Spur, Traktor"),
    "line_to_drive": ("Line to drive", "Linie zum Fahren"),
    "field": ("Field", "Feld"),
    "line": ("Line", "Linie"),
    "pass_number": ("Pass", "Spur"),
    "working_width": ("Working width", "Arbeitsbreite"),
    "offset": ("Offset to the left", "Versatz nach links"),
    "pass_help": (
        "Pass 1 lies one working width to the left of the line, pass −1 to the right.",
        "Spur 1 liegt eine Arbeitsbreite links der Linie, Spur −1 rechts.",
    ),
    "planning": ("Computing …", "Rechnet …"),
    "take_line": ("Take for the next drive", "Für die nächste Fahrt nehmen"),
    "smoothed": (
        "{length} m. Smoothed by at most {most} cm (limit {limit} cm).",
        "{length} m. Um höchstens {most} cm geglättet (Grenze {limit} cm).",
    ),
    "smoothed_marked": (
        "{length} m. Smoothed by at most {most} cm (limit {limit} cm), more than 2 cm where it is red and thick.",
        "{length} m. Um höchstens {most} cm geglättet (Grenze {limit} cm), mehr als 2 cm, wo es rot und dick ist.",
    ),
    "no_field": (
        "There is no field yet. Record a line or import one.",
        "Noch kein Feld. Linie aufnehmen oder einlesen.",
    ),
    "new_field": ("New field", "Neues Feld"),
    "new_line": ("New line", "Neue Linie"),
    "name_of_line": ("Name of the new line", "Name der neuen Linie"),
    "set_a": ("Set A here", "A hier setzen"),
    "set_b": ("Set B here", "B hier setzen"),
    "heading": ("Heading", "Richtung"),
    "a_and_heading": ("A and heading", "A und Richtung"),
    "record_curve": ("● Record a curve", "● Kurve aufnehmen"),
    "end_curve": ("■ End and keep", "■ Beenden, behalten"),
    "drop_curve": ("Discard", "Verwerfen"),
    "curve": ("Curve", "Kurve"),
    "no_position": ("Waiting for an RTK-fixed position", "Warten auf RTK-Fix"),
    "recording_points": ("Recording: {count} points", "Aufnahme: {count} Punkte"),
    "a_is_set": ("A is set; drive to B", "A ist gesetzt; nach B fahren"),
    "import_export": ("Import and export", "Einlesen und ausgeben"),
    "import_file": ("File of a field", "Datei eines Feldes"),
    "import_kinds": ("{kinds}; folders as .zip", "{kinds}; Ordner als .zip"),
    "imported": ("Imported {fields}: {lines} lines", "{fields} eingelesen: {lines} Linien"),
    "left_out": ("Left out: {what}", "Ausgelassen: {what}"),
    "format": ("Format", "Format"),
    "export": ("Export", "Ausgeben"),
    # set-up
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
    "tractor_mast_up": ("Tractor, height (0: unknown)", "Traktor, Höhe (0: unbekannt)"),
    "trailer_mast_forward": ("Trailer, before point", "Anhänger, vor Punkt"),
    "trailer_mast_left": ("Trailer, left", "Anhänger, links"),
    "trailer_mast_up": ("Trailer, height (0: unknown)", "Anhänger, Höhe (0: unbekannt)"),
    "driving_speed": ("Driving speed", "Fahrtempo"),
    "smallest_radius": ("Smallest radius of lines", "Kleinster Radius der Linien"),
    "wheels_limit": ("Front wheels, most", "Vorderräder, höchstens"),
    "joint_limit": ("Steered joint, most", "Lenkgelenk, höchstens"),
    "wheels_rate": ("Front wheels, fastest", "Vorderräder, schnellstens"),
    "joint_rate": ("Steered joint, fastest", "Lenkgelenk, schnellstens"),
    "steering_lag": ("Lag of the steerings", "Trägheit der Lenkungen"),
    "dead_time": ("Dead time", "Totzeit"),
    "smoothing_limit": ("Lines smoothed by, most", "Linien geglättet, höchstens"),
    "drawing_help": (
        "From the side and from above, to scale, front on the right. Touch a letter to change its number.",
        "Von der Seite und von oben, im Maßstab, vorn ist rechts. Buchstaben berühren, um die Zahl zu ändern.",
    ),
    "changes": ("Changes", "Änderungen"),
    "no_changes": ("No number is changed.", "Keine Zahl ist geändert."),
    "save_version": ("Save as a new version", "Als neue Version speichern"),
    "undo": ("Undo", "Rückgängig"),
    "saving_help": (
        "Acts on the next drive that is started with the new version, not on this one.",
        "Wirkt in der nächsten Fahrt, die mit der neuen Version beginnt, nicht in dieser.",
    ),
    "only_maintainer": ("Only a maintainer may change this.", "Nur wer wartet, darf das ändern."),
    "versions": ("Versions", "Versionen"),
    "go_on_from": ("Go on from this", "Hiermit weiter"),
    "devices": ("Devices: how often, how long ago", "Geräte: wie oft, wie lange her"),
    "tractor_receiver": ("Tractor's receiver", "Empfänger Traktor"),
    "trailer_receiver": ("Trailer's receiver", "Empfänger Anhänger"),
    "hitch_sensor": ("Hitch angle", "Knickwinkel"),
    "wheel_sensor": ("Wheel speed", "Radsensor"),
    "tractor_steering_sensor": ("Angle of front wheels", "Winkel Vorderräder"),
    "trailer_steering_sensor": ("Angle of steered joint", "Winkel Lenkgelenk"),
    "controller": ("Controller", "Regler"),
    "gate": ("Gate", "Wächter"),
    # calibration
    "calibrate": ("Calibrate by driving", "Beim Fahren kalibrieren"),
    "calibrate_help": (
        "By hand on a level field, RTK fixed: 1 straight 30 m; 2 three circles to the left, 3 three to the right, each "
        "with the wheel held for 6 s; 4 back along the same straight.",
        "Von Hand auf ebenem Feld, RTK Fix: 1 geradeaus 30 m; 2 drei Kreise links, 3 drei rechts, das Lenkrad je 6 s "
        "gehalten; 4 auf derselben Geraden zurück.",
    ),
    "calibrate_begin": ("● Begin", "● Beginnen"),
    "calibrate_evaluate": ("■ End and evaluate", "■ Beenden, auswerten"),
    "calibrate_keep": ("Save what was found", "Gefundenes speichern"),
    "calibrate_drive": ("Drive now.", "Jetzt fahren."),
    "calibrate_driven": (
        "Straight {straight} m of 30; circles: left {left} of 3, right {right} of 3",
        "Gerade {straight} m von 30; Kreise: links {left} von 3, rechts {right} von 3",
    ),
    "calibrate_found": ("Found: {count}", "Gefunden: {count}"),
    "calibrate_nothing": (
        "Nothing can be evaluated: too few steps, or no devices.",
        "Nichts auszuwerten: zu wenige Schritte oder keine Geräte.",
    ),
    # runs
    "compare_two": ("Compare two runs", "Zwei Fahrten vergleichen"),
    "run_a": ("Run A", "Fahrt A"),
    "run_b": ("Run B", "Fahrt B"),
    "compare": ("Compare", "Vergleichen"),
    "events": ("Events", "Ereignisse"),
    "no_events": ("This run has no events: it was simulated.", "Diese Fahrt hat keine Ereignisse: simuliert."),
    "operator_pressed": ("Asked for: {what}", "Verlangt: {what}"),
    "delete": ("Delete", "Löschen"),
    "delete_really": ("Delete {name} with all its files?", "{name} mit allen Dateien löschen?"),
    "delete_now": ("Delete now", "Jetzt löschen"),
    "keep": ("Keep", "Behalten"),
    "duration": ("Duration", "Dauer"),
    "driven_length": ("Driven along the line", "Gefahren, entlang der Linie"),
    "error_mean": ("Mean error", "Mittlerer Fehler"),
    "error_rms": ("RMS error", "Effektivwert des Fehlers"),
    "error_p95": ("Error, 95 %", "Fehler, 95 %"),
    "error_max": ("Largest error", "Größter Fehler"),
    "steering_effort": ("Mean steering rate", "Mittlere Lenkrate"),
    "tube_margin": ("Least margin in the tube", "Kleinster Abstand zum Rand des Schlauchs"),
    "rejected_fixes": ("Rejected fixes", "Abgelehnte Positionen"),
    "solver_failures": ("Solver failures", "Fehlschläge der Löser"),
    "refused_commands": ("Refused commands", "Abgelehnte Befehle"),
    "estimator_time": ("Estimator, p99 of a call", "Schätzer, p99 eines Aufrufs"),
    # look inside
    "plot": ("Plot", "Kurven"),
    "signals": ("Signals", "Signale"),
    "pause": ("Pause", "Anhalten"),
    "go_on": ("Go on", "Weiter"),
    "no_steps": ("No control step has been heard yet.", "Noch kein Schritt des Reglers gehört."),
    "plot_errors": ("Errors (m)", "Fehler (m)"),
    "plot_times": ("Solver times (s)", "Rechenzeiten (s)"),
    "plot_tubes": ("Tube margins", "Abstand zum Rand des Schlauchs"),
    "plot_slips": ("Slip factors ± deviation (1)", "Schlupffaktoren ± Streuung (1)"),
    "plot_angles": ("Side slips, offset ± deviation (rad)", "Schräglauf, Versatz ± Streuung (rad)"),
    "plot_certainty": ("Deviation across, heading (m, rad)", "Streuung quer, Richtung (m, rad)"),
    "plot_steering": ("Steering (rad)", "Lenkung (rad)"),
    "menu": ("Menu", "Menü"),
    "look": ("Light or dark", "Hell oder dunkel"),
    "sound": ("Sound on or off", "Ton an oder aus"),
    "language": ("Deutsch", "English"),
    "logout": ("Log out", "Abmelden"),
    "login": ("Log in", "Anmelden"),
    "name": ("Name", "Name"),
    "password": ("Password", "Passwort"),
    "login_failed": ("Name or password is wrong", "Name oder Passwort ist falsch"),
    "login_wait": ("Too many attempts: wait a minute", "Zu viele Versuche: eine Minute warten"),
    "no_runs": ("There are no runs in {folder}.", "In {folder} gibt es keine Fahrten."),
    "open_report": ("Open the report", "Bericht öffnen"),
    "no_report": ("no report yet", "noch kein Bericht"),
}


class Words:
    """The texts in one language."""

    def __init__(self, language: Language) -> None:
        """Choose the language."""
        self.language: Language = language

    def __call__(self, key: str, **values: object) -> str:
        """Return a text with its values in it."""
        return TEXTS[key][self.language == "de"].format(**values)

    def cause(self, cause: Cause) -> tuple[str, str]:
        """Return what a cause says, and what to do about it, as sentences that begin with a capital letter."""
        sentence, advice = CAUSES_DE[cause] if self.language == "de" else (cause.sentence, cause.advice)
        return sentence[:1].upper() + sentence[1:], advice[:1].upper() + advice[1:]

    def number(self, value: float, decimals: int) -> str:
        """Return a number as people write it."""
        text = f"{value:z.{decimals}f}"
        return text.replace(".", ",") if self.language == "de" else text


def language_of(accepted: str, otherwise: Language) -> Language:
    """Return the language that a browser asks for first, of those that there are (header Accept-Language)."""
    for each in accepted.lower().split(","):
        if each.strip()[:2] in ("en", "de"):
            return "de" if each.strip().startswith("de") else "en"
    return otherwise
