"""Refusals in German: what calibrations call what they find, and why they refuse it (as errors_de.py)."""

from collections.abc import Mapping

REFUSALS_DE: Mapping[str, str] = {
    # calibration: names and units
    "front wheels": "Vorderräder",
    "joint": "Lenkgelenk",
    "front wheels: zero": "Vorderräder: Nullpunkt",
    "front wheels: scale": "Vorderräder: Maßstab",
    "{}: dead band": "{0}: Totbereich",
    "motions from rest: {}, needed: {}; let drawbar steer slow curves for two minutes (a steering that never rests "
    "has no dead band)":
        "Bewegungen aus der Ruhe: {0}, nötig: {1}; drawbar zwei Minuten sanfte Kurven lenken lassen (eine Lenkung, "
        "die nie ruht, hat keinen Totbereich)",
    "{}: rate": "{0}: Geschwindigkeit",
    "{} s of steering without a gap; let drawbar steer for a minute":
        "{0} s ohne Lücke gelenkt; drawbar eine Minute lang lenken lassen",
    "a steering did not follow its commands; look at its sensor and its actuator, and drive again":
        "eine Lenkung folgte ihren Befehlen nicht; Sensor und Antrieb ansehen, dann noch einmal fahren",
    "known too roughly; let drawbar steer through curves, and onto its line from a metre beside it":
        "zu ungenau bekannt; drawbar durch Kurven lenken lassen, und von einem Meter daneben auf die Linie",
    "{} in the first half and {} in the second; drive again":
        "{0} in der ersten Hälfte und {1} in der zweiten; noch einmal fahren",
    "joint: zero": "Lenkgelenk: Nullpunkt",
    "hitch angle: zero": "Knickwinkel: Nullpunkt",
    "wheel speed": "Radsensor",
    "{}: mounting roll": "{0}: Rollwinkel des Einbaus",
    "tractor": "Traktor",
    "trailer": "Anhänger",
    "counts": "Zählschritte",
    "counts per degree": "Zählschritte je Grad",
    "reported per true": "gemeldet / wahr",
    "left": "links",
    "right": "rechts",
    # calibration: why not
    "{} s of straight driving; drive 30 m straight at 1 to 2 m/s":
        "{0} s geradeaus; 30 m geradeaus fahren, mit 1 bis 2 m/s",
    "{} s at {} to {} m/s; drive {} m straight at 1 to 2 m/s":
        "{0} s mit {1} bis {2} m/s; {3} m geradeaus fahren, mit 1 bis 2 m/s",
    "{} m were driven; drive {} m at least": "{0} m gefahren; mindestens {1} m fahren",
    "the mean curvature is {} 1/m; drive straighter, {} at most":
        "die mittlere Krümmung ist {0} 1/m; gerader fahren, höchstens {1}",
    "no polynomial of degree 3 leaves less than {}° of these circles and has an inverse; hold the steering in each "
    "circle, and check the sensor's lever for play":
        "keine Kurve passt auf weniger als {0}° zu diesen Kreisen; die Lenkung in jedem Kreis halten, Hebel des "
        "Sensors auf Spiel prüfen",
    "the zero is not to be used: {}": "der Nullpunkt taugt nicht: {0}",
    "a circle has less than 3 s at {} m/s and above; drive it longer":
        "ein Kreis hat weniger als 3 s mit {0} m/s und mehr; länger fahren",
    "{} circles to the {} above 3°; drive {} of different angles":
        "{0} Kreise nach {1} über 3°; {2} mit verschiedenen Winkeln fahren",
    "a board cannot store {}; check the sensor's lever and its way":
        "eine Platine kann {0} nicht speichern; Hebel und Weg des Sensors prüfen",
    "the counts do not follow the angle; check the sensor": "die Zählschritte folgen dem Winkel nicht; Sensor prüfen",
    "the antenna's height {} m is below 0.5 m; measure it above the ground":
        "die Höhe der Antenne, {0} m, ist unter 0,5 m; über dem Boden messen",
    "{} times {} s one way; drive {} s each way": "{0}-mal {1} s in einer Richtung; je Richtung {2} s fahren",
    "the ways lie {} m apart, more than {}° of mounting roll; was it the same track, and is the antenna's offset to "
    "the side taken out?":
        "die Wege liegen {0} m auseinander, mehr als {1}° Rollwinkel; war es dieselbe Spur, und ist „Traktor, links“ "
        "der Antenne eingetragen?",
    "{} s of driving; drive two minutes of S-curves": "{0} s gefahren; zwei Minuten Schlangenlinien fahren",
    "the wheels explain the track to {} m only, {} m at most; calibrate the front wheels first, and drive where they "
    "do not slip":
        "Räder und Spur passen nur auf {0} m zusammen, höchstens {1} m sind erlaubt; zuerst die Vorderräder "
        "kalibrieren, und fahren, wo sie nicht rutschen",
    "a roll sensor's zero looks like an antenna's place to the side; measure that place":
        "der Nullpunkt eines Rollsensors sieht aus wie ein Platz der Antenne zur Seite; diesen Platz messen",
    "tractor: antenna {}": "Traktor: Antenne {0}",
    "forward": "nach vorn",
    "{} s of turning {} faster than {} rad/s; drive 10 s at least":
        "{0} s Kurve nach {1}, schneller als {2} rad/s; mindestens 10 s fahren",
    "its deviation of {} m is above {} m; drive longer, in tighter and quicker S-curves":
        "die Unsicherheit von {0} m ist über {1} m; länger fahren, in engeren und schnelleren Schlangenlinien",
    # valves and motors without a loop of their own
    "{}: full rate": "{0}: größte Geschwindigkeit",
    "{}: lag": "{0}: Verzögerung",
    "{}: dead time": "{0}: Totzeit",
    "of the full drive": "der vollen Ansteuerung",
    "in no run did three pushes move more than {}°; push further":
        "in keiner Reihe bewegte sich dreimal etwas um mehr als {0}°; weiter steigern",
    "runs that moved: {}, needed: {}": "Reihen mit Bewegung: {0}, nötig: {1}",
    "a dead band of {} cannot be; check the valve's supply and the sensor":
        "ein Totbereich von {0} kann nicht sein; Druck oder Strom und den Sensor prüfen",
    "the runs differ by {} of the drive; warm the oil up, and repeat":
        "die Reihen unterscheiden sich um {0} der Ansteuerung; Öl warm fahren, dann wiederholen",
    "pushes: {}, with samples: {}; make {}, with 10 samples a second or more":
        "Stöße: {0}, Werte: {1}; nötig sind {2} Stöße, mit 10 Werten je Sekunde oder mehr",
    "the angle moved by {}°; push longer, to 3° at least":
        "der Winkel bewegte sich um {0}°; länger ansteuern, mindestens bis 3°",
    "the fit leaves {}°; the pushes differ, or the wheels hit their stop":
        "die Stöße unterscheiden sich um {0}°, oder die Räder stehen am Anschlag",
    "the angle does not follow the drive; find the drive's direction first":
        "der Winkel folgt der Ansteuerung nicht; zuerst deren Richtung klären",
    "direction of the drive": "Richtung der Ansteuerung",
    "(1: positive turns left, -1: right)": "(1: positiv dreht nach links, -1: nach rechts)",
    "front wheels: angle by the yaw rate / by the sensor": "Vorderräder: Winkel nach Drehrate / nach Sensor",
    "rests: {}, within {}°; push again, rolling straight":
        "Ruhelagen: {0}, innerhalb von {1}°; noch einmal, geradeaus rollend",
    "the yaw rate tells it to {} only; roll faster, at 1 m/s, straight ahead":
        "die Drehrate sagt es nur auf {0} genau; schneller rollen, mit 3,5 km/h, geradeaus",
    "{} names no valve or motor to push; add [devices.bare_valve] with transport, counts and angles "
    "(docs/calibration.md)":
        "{0} nennt weder Ventil noch Motor; [devices.bare_valve] mit transport, counts und angles ergänzen "
        "(docs/calibration.md)",
    "stopped by the operator": "von Hand beendet",
    "drawbar steers now; stop, then begin again": "drawbar lenkt jetzt; anhalten, dann neu beginnen",
    "no picture was drawn for {} s; keep the page in front, and begin again":
        "{0} s lang wurde kein Bild gezeichnet; die Seite vorn behalten, und neu beginnen",
    "a drive of {} is beyond the {} that are allowed": "Ansteuerung {0}; erlaubt sind höchstens {1}",
    "the angle sensor reports nothing or is outside its range; check its cable":
        "der Winkelsensor meldet nichts oder ist außerhalb seines Bereichs; Kabel prüfen",
    "the vehicle's speed is unknown; check the receiver": "das Tempo des Fahrzeugs fehlt; Empfänger prüfen",
    "the vehicle drives at {} m/s; keep it between {} and {} m/s: standing tyres are not turned":
        "das Fahrzeug fährt mit {0} m/s; zwischen {1} und {2} m/s halten: stehende Reifen werden nicht gedreht",
    "{} s between two reports of the sensor, {} s at most; check its link":
        "{0} s zwischen zwei Meldungen des Sensors, höchstens {1} s sind erlaubt; Verbindung prüfen",
    "it has taken more than {} s; begin again": "es hat mehr als {0} s gedauert; neu beginnen",
    "runaway: it has turned {}° from where it began; shut the valve off and look":
        "durchgegangen: {0}° von dort gedreht, wo es begann; Ventil schließen und nachsehen",
    "runaway: it turns faster than {}°/s; shut the valve off and look":
        "durchgegangen: dreht schneller als {0}°/s; Ventil schließen und nachsehen",
    "runaway: it turns without a drive, {}°; the valve leaks, or another drives":
        "durchgegangen: dreht ohne Ansteuerung, {0}°; das Ventil leckt, oder etwas anderes steuert an",
    "runaway: it has turned {}° against the drive; check for a valve that sticks or leaks, and for a swapped sensor":
        "durchgegangen: {0}° gegen die Ansteuerung gedreht; prüfen, ob das Ventil hängt oder leckt, oder der Sensor "
        "vertauscht ist",
    "the vehicle's yaw rate is unknown: a sensor that is stuck would not be seen; let the tractor's receiver report it "
    "(docs/receivers.md)":
        "die Drehrate des Fahrzeugs fehlt: ein hängender Sensor fiele nicht auf; der Empfänger des Traktors "
        "muss sie melden (docs/receivers.md)",
    "runaway: by its yaw rate the vehicle is steered {}° further than the sensor says; the sensor is stuck or its "
    "lever is loose":
        "durchgegangen: nach der Drehrate lenkt das Fahrzeug um {0}° anders, als der Sensor sagt; der Sensor hängt, "
        "oder sein Hebel ist lose",
    "no feedback: up to a drive of {} no {} pushes moved it by {}°; check the valve's power and the sensor's lever":
        "keine Rückmeldung: bis zur Ansteuerung {0} bewegten keine {1} Stöße etwas um {2}°; Strom oder Druck und "
        "den Hebel des Sensors prüfen",
}  # fmt: skip
