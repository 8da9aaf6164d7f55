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
    "map": ("Map: line, tractor, trailer and plan", "Karte: Linie, Traktor, Anhänger und Plan"),
    "zoom_in": ("Closer", "Näher"),
    "zoom_out": ("Farther", "Weiter"),
    "whole": ("Whole line", "Ganze Linie"),
    # pages
    "drive": ("Drive", "Fahren"),
    "runs": ("Runs", "Fahrten"),
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
        text = f"{value:.{decimals}f}"
        return text.replace(".", ",") if self.language == "de" else text


def language_of(accepted: str, otherwise: Language) -> Language:
    """Return the language that a browser asks for first, of those that there are (header Accept-Language)."""
    for each in accepted.lower().split(","):
        if each.strip()[:2] in ("en", "de"):
            return "de" if each.strip().startswith("de") else "en"
    return otherwise
