"""Errors in German: what an operator may read of `DrawbarError`s; of refused calibrations in refusals_de.py.

Keys are the English texts as they stand in the code, `{}` for each value in them; `{0}`, `{1}` are these values in
order. The English text stays where the error is raised; a test compares both.
"""

from collections.abc import Mapping

from drawbar.console.language.refusals_de import REFUSALS_DE

ERRORS_DE: Mapping[str, str] = {
    **REFUSALS_DE,
    # files of fields
    "{}: is of none of the types {}, .csv, .kmz and .zip; give one of these":
        "{0}: hat keinen der Typen {1}, .csv, .kmz und .zip; eine solche Datei wählen",
    "{}: holds neither a line nor a boundary": "{0}: enthält weder eine Linie noch eine Grenze; andere Datei wählen",
    "{}: holds neither a line nor a boundary but {}":
        "{0}: enthält weder eine Linie noch eine Grenze, sondern: {1}; andere Datei wählen",
    "nothing": "nichts",
    "hole": "Loch",
    "places to better than {} m, by the conversion from {}":
        "Lage genauer als {0} m, durch die Umrechnung aus {1}",
    "waypoint {}": "Wegpunkt {0}",
    "polygon": "Fläche",
    "line '{}' of fewer than {} different points": "Linie „{0}“ mit weniger als {1} verschiedenen Punkten",
    "{}: holds no field; a folder of AgOpenGPS, TASKDATA.XML, or .shp, .kml, .gpx, .geojson, .csv":
        "{0}: enthält kein Feld; möglich sind ein Ordner von AgOpenGPS, TASKDATA.XML, .shp, .kml, .gpx, .geojson, .csv",
    "{}: cannot be unpacked: {}; pack it again": "{0}: lässt sich nicht entpacken ({1}); neu packen",
    "{} cannot be the name of a file ({}); rename it": "{0} kann keine Datei heißen ({1}); umbenennen",
    "{}: holds more than {} files or {} MiB; pack the field alone":
        "{0}: enthält mehr als {1} Dateien oder {2} MiB; das Feld allein packen",
    "{} has fewer than {} different points; draw it again":
        "{0} hat weniger als {1} verschiedene Punkte; neu zeichnen",
    "{}, point {}: latitude {}, longitude {}; degrees within ±90 and ±180 are needed":
        "{0}, Punkt {1}: Breite {2}, Länge {3}; Grad innerhalb von ±90 und ±180 sind nötig",
    "{}: line '{}'": "{0}: Linie „{1}“",
    "{}: the boundary": "{0}: die Grenze",
    "{}, point {}": "{0}, Punkt {1}",
    "{}, feature {}": "{0}, Objekt {1}",
    "{}, position {}": "{0}, Stelle {1}",
    "{}: partfield {}": "{0}: Schlag {1}",
    "field {} has no line {}; its lines are: {}": "Feld {0} hat keine Linie {1}; seine Linien: {2}",
    "field {} holds neither a line nor a boundary; record or import one":
        "Feld {0} hat weder Linie noch Grenze; eine Linie aufzeichnen oder eine Datei importieren",
    "{}: is {}; {} is needed": "{0}: ist {1}; nötig ist {2}",
    "{}: 'coordinates' is no list": "{0}: „coordinates“ ist keine Liste; Datei neu exportieren",
    "{}: 'coordinates' is no list of positions":
        "{0}: „coordinates“ ist keine Liste von Positionen; Datei neu exportieren",
    "{}: {} is no longitude,latitude in degrees": "{0}: {1} ist nicht Länge,Breite in Grad",
    "{}: has no {}.prj beside it, so that nobody knows its projection; export it too":
        "{0}: {1}.prj fehlt daneben, die Projektion ist unbekannt; mit exportieren",
    "{}: has no {}.dbf beside it, with the names of its lines; export it too":
        "{0}: {1}.dbf mit den Namen der Linien fehlt daneben; mit exportieren",
    "{}: is no projection of the ground but {}; export in WGS84":
        "{0}: keine Projektion der Erdoberfläche ({1}); in WGS84 exportieren",
    "{}: refers to {}.XML, which is not beside it; give the folder TASKDATA as .zip":
        "{0}: verweist auf {1}.XML, die daneben fehlt; den Ordner TASKDATA als .zip wählen",
    "{}: is no table: {}; export it again": "{0}: ist keine Tabelle ({1}); neu exportieren",
    "{}: cannot be read as a shapefile: {}; export it again": "{0}: ist kein lesbares Shapefile ({1}); neu exportieren",
    "{}: is no projection that is known: {}; export in WGS84": "{0}: unbekannte Projektion ({1}); in WGS84 exportieren",
    "{}: declares a document type (DOCTYPE), which no such file needs; export it again without":
        "{0}: hat einen Dokumenttyp (DOCTYPE), den keine solche Datei braucht; neu exportieren, ohne ihn",
    "{}: its root is <{}>; {} has <{}>": "{0}: beginnt mit <{1}>; {2} beginnt mit <{3}>",
    "{}: is not XML: {}; export it again": "{0}: ist kein XML ({1}); neu exportieren",
    "{}: {} of <{}> is {}; a number in degrees is needed": "{0}: {1} von <{2}> ist {3}; eine Zahl in Grad ist nötig",
    "{}: is a binary file; give a text file": "{0}: ist keine Textdatei; die richtige Datei wählen",
    "{}: is empty; a line needs at least two points": "{0}: ist leer; eine Linie hat mindestens zwei Punkte",
    "{}: byte {} is not UTF-8 text; give a text file, saved as UTF-8":
        "{0}: Byte {1} ist kein Text (UTF-8); eine Textdatei wählen, als UTF-8 gespeichert",
    "{}: cannot be read: {}; give an existing file": "{0}: nicht lesbar ({1}); eine vorhandene Datei wählen",
    "{}: {} is {}; a number like -12.5 is needed": "{0}: {1} ist {2}; eine Zahl wie -12.5 ist nötig",
    "the latitude": "die Breite",
    "the longitude": "die Länge",
    "the number of points": "die Zahl der Punkte",
    "the nudge distance": "die Verschiebung",
    "the mode": "die Art",
    "{}: is {}; {} numbers separated by commas are needed, with decimal points, or all with decimal commas":
        "{0}: ist {1}; nötig sind {2} Zahlen, durch Kommas getrennt, alle mit Punkt oder alle mit Komma",
    "{}: is not valid JSON: {}": "{0}: ist kein gültiges JSON ({1}); neu exportieren",
    "{}: is {}; [longitude, latitude] in degrees is needed": "{0}: ist {1}; nötig ist [Länge, Breite] in Grad",
    "{}: longitude {}, latitude {}; they must lie within ±180° and ±90°: GeoJSON is WGS84 in degrees, longitude first":
        "{0}: Länge {1}, Breite {2}; erlaubt sind ±180° und ±90°: GeoJSON ist WGS84 in Grad, Länge zuerst",
    "{}: its crs is {}; only WGS84 is read (CRS84 or EPSG:4326, longitude first): convert the file to EPSG:4326":
        "{0}: sein crs ist {1}; gelesen wird nur WGS84: nach EPSG:4326 umwandeln",
    "{}: {} is {}; a list is needed": "{0}: {1} ist {2}; eine Liste ist nötig",
    "{}: holds no LineString but {}; give each line as a LineString: alone, as a Feature or in a FeatureCollection":
        "{0}: enthält keinen LineString, sondern {1}; jede Linie als LineString exportieren",
    "no feature": "kein Objekt",
    "{}: holds no line: {}; record one in AgOpenGPS": "{0}: enthält keine Linie ({1}); in AgOpenGPS eine aufzeichnen",
    "{}: has no {}; give the folder of one AgOpenGPS field, which holds {} and {}":
        "{0}: {1} fehlt; der Ordner eines AgOpenGPS-Feldes enthält {2} und {3}",
    "{}: has no row 'StartFix' with the field's origin 'latitude,longitude' below; give a field folder as AgOpenGPS "
    "writes it":
        "{0}: die Zeile „StartFix“ mit dem Ursprung darunter fehlt; den Ordner nehmen, wie AgOpenGPS ihn schreibt",
    "{}:{}: origin {}; degrees within ±90 and ±180 are allowed":
        "{0}:{1}: Ursprung {2}; Grad innerhalb von ±90 und ±180 sind erlaubt",
    "{}: is {}; a row of ABLines.txt is name,heading,easting,northing":
        "{0}: ist {1}; eine Zeile von ABLines.txt ist Name,Richtung,Ost,Nord",
    "{}:1: is {}; an AgOpenGPS file of lines starts with {}":
        "{0}:1: ist {1}; eine Liniendatei von AgOpenGPS beginnt mit {2}",
    "{}:{}: line {} has a nudge of {} m; only 0 can be driven: move the reference line itself in AgOpenGPS":
        "{0}:{1}: Linie {2} ist um {3} m verschoben; nur 0 ist fahrbar: in AgOpenGPS die Linie selbst verschieben",
    "{}:{}: the file ends inside line {}; export the field from AgOpenGPS again":
        "{0}:{1}: die Datei endet mitten in Linie {2}; das Feld neu aus AgOpenGPS exportieren",
    "{}:{}: line {} announces points: {}, but holds {}; export the field from AgOpenGPS again":
        "{0}:{1}: Linie {2} kündigt Punkte an: {3}, enthält aber {4}; das Feld neu aus AgOpenGPS exportieren",
    "{}:{}: announces {} points; a whole number is allowed: export the field from AgOpenGPS again":
        "{0}:{1}: kündigt {2} Punkte an; erlaubt ist eine ganze Zahl: das Feld neu aus AgOpenGPS exportieren",
    "{}:{}: announces {} points, but holds {}; export the field from AgOpenGPS again":
        "{0}:{1}: kündigt {2} Punkte an, enthält aber {3}; das Feld neu aus AgOpenGPS exportieren",
    "{}: does not exist; give an AgOpenGPS field folder or a file of type {}":
        "{0}: gibt es nicht; den Ordner eines AgOpenGPS-Feldes oder eine Datei des Typs {1} wählen",
    "{}: is neither an AgOpenGPS field folder nor a file of type {}; give one of these (the console's fields page "
    "imports other types, and keeps them as GeoJSON)":
        "{0}: ist weder Ordner eines AgOpenGPS-Feldes noch Datei des Typs {1}; eines davon wählen (andere Typen "
        "importiert die Seite Felder und Linien und behält sie als GeoJSON)",
    "{}:{}: is {}; finite coordinates in m are needed": "{0}:{1}: ist {2}; endliche Koordinaten in m sind nötig",
    "{}:{}: the file ends within the origin; export the field from AgOpenGPS again":
        "{0}:{1}: die Datei endet im Ursprung; das Feld neu aus AgOpenGPS exportieren",
    # lines
    "line {}: A and B are {} m apart; {} m are needed": "Linie {0}: A und B liegen {1} m auseinander; {2} m sind nötig",
    "A and B are {} m apart; {} m are needed: drive on, then set B":
        "A und B liegen {0} m auseinander; {1} m sind nötig: weiterfahren, dann B setzen",
    "the heading is {}; give degrees from 0 (north) to 360, clockwise":
        "Die Richtung ist {0}; Grad von 0 (Nord) bis 360 eingeben, im Uhrzeigersinn",
    "the working width is {} m; 0.1 to {} m are allowed": "Die Arbeitsbreite ist {0} m; erlaubt sind 0,1 bis {1} m",
    "the offset is {} m; at most {} m to either side are allowed":
        "Der Versatz ist {0} m; höchstens {1} m zu jeder Seite sind erlaubt",
    "pass {} is {} m beside the line; at most {} m are allowed":
        "Spur {0} liegt {1} m neben der Linie; höchstens {2} m sind erlaubt",
    "nothing is left of the line at {} m beside it; it is curved too tightly there":
        "{0} m neben der Linie bleibt nichts von ihr übrig; sie ist zu eng gekrümmt: kleineren Abstand wählen",
    "{} m of the line would have no pass at {} m beside it, since it crosses itself or comes back to itself; take a "
    "smaller distance, or divide the line":
        "{0} m der Linie hätten keine Spur {1} m daneben, weil sie sich kreuzt oder zu sich zurückkehrt: kleineren "
        "Abstand wählen, oder die Linie teilen",
    "the recorded curve is {} m long; {} m are needed: drive on":
        "Die aufgenommene Kurve ist {0} m lang; {1} m sind nötig: weiterfahren",
    "{}: the line does not cross the field of {}; say how far it goes by path.extension, m":
        "{0}: die Linie kreuzt das Feld von {1} nicht; andere Spur oder anderes Feld wählen",
    "{}: point {} m of line {}; coordinates must be finite and within ±{} m of the origin: remove the point, or use "
    "an origin in the field":
        "{0}: Punkt {1} m der Linie {2}; erlaubt sind ±{3} m vom Ursprung: den Punkt entfernen",
    "{}: line {} jumps {} m to {} m; at most {} m are allowed between its neighbours: remove the faulty point":
        "{0}: Linie {1} springt {2} m weit nach {3} m; zwischen Nachbarn sind höchstens {4} m erlaubt: den falschen "
        "Punkt entfernen",
    "{}: line {} has fewer than two different points; it needs at least two that are more than {} mm apart":
        "{0}: Linie {1} hat keine zwei verschiedenen Punkte; nötig sind zwei, die mehr als {2} mm auseinander liegen",
    "{}: header {}; two columns are read, x (east) and y (north) in m: name them x,y in this order or remove the "
    "header; degrees belong in GeoJSON, or, for the console's import, under the header line,latitude,longitude":
        "{0}: Kopfzeile {1}; gelesen werden zwei Spalten, x (Ost) und y (Nord) in m: sie in dieser Reihenfolge x,y "
        "nennen oder die Kopfzeile entfernen; Grad gehören in GeoJSON, oder, beim Import hier, unter die Kopfzeile "
        "line,latitude,longitude",
    "{}: {} has {}; two are needed, x and y in m, as in '12.5,-3.0'":
        "{0}: {1} hat {2}; nötig sind zwei, x und y in m, wie in '12.5,-3.0'",
    "1 column": "1 Spalte",
    "{} columns": "{0} Spalten",
    "{}: line {} is {} m long; {} m to {} km are allowed: are its coordinates in metres, as CSV and AgOpenGPS have "
    "them, or in degrees, as GeoJSON has them?":
        "{0}: Linie {1} ist {2} m lang; erlaubt sind {3} m bis {4} km: Sind es Meter (CSV, AgOpenGPS) oder Grad "
        "(GeoJSON)?",
    "{}: latitude {}°, longitude {}° is more than {} km from latitude {}°, longitude {}°, where the metres count "
    "from: remove the point, or correct the origin":
        "{0}: Breite {1}°, Länge {2}° liegt mehr als {3} km von Breite {4}°, Länge {5}° entfernt: den Punkt "
        "entfernen, oder eine Linie dieses Feldes wählen",
    "{}: has no line {}{}; its lines are: {}": "{0}: hat keine Linie {1}{2}; seine Linien: {3}",
    " (did you mean {}?)": " (gemeint: {0}?)",
    "{}: holds {} lines: {}; choose one with --track NAME or path.track":
        "{0}: enthält {1} Linien: {2}; eine davon wählen",
    "{}: has {} lines named {}; give them different names": "{0}: hat {1} Linien namens {2}; verschieden benennen",
    "offset = {} m: the path curves too tightly for a line so far beside it; give less than {} m to this side":
        "Versatz {0} m: für eine Parallele so weit daneben ist die Linie zu eng gekrümmt; nach dieser Seite weniger "
        "als {1} m angeben",
    "line {} is too tight for the vehicle along {} m, from ({}, {}) m on; at most {} m of kinks in a row can be "
    "rounded: smooth or redraw the line there":
        "Linie {0} ist auf {1} m zu eng für das Fahrzeug, ab ({2}; {3}) m; höchstens {4} m Knicke hintereinander "
        "lassen sich runden: die Linie dort glätten oder neu zeichnen",
    "line {} is too tight for the vehicle: recorded point {} at ({}, {}) m is {} m from the closest path within {} "
    "1/m; at most {} m is allowed: raise guidance.path_tolerance, or vehicle.curvature_limit if it can turn tighter, "
    "or redraw the line there":
        "Linie {0} ist zu eng für das Fahrzeug: Punkt {1} bei ({2}; {3}) m liegt {4} m neben dem nächsten fahrbaren "
        "Weg (Krümmung bis {5} 1/m); erlaubt sind {6} m: unter Einrichten mehr Glättung oder einen kleineren Radius "
        "erlauben, oder die Linie dort neu zeichnen",
    "line {} cannot be made drivable: near ({}, {}) m its {} stays at {} {}; at most {} {} is allowed: redraw the "
    "line without this turn":
        "Linie {0} ist nicht fahrbar: bei ({1}; {2}) m bleibt ihre {3} bei {4} {5}; erlaubt sind {6} {7}: die Linie "
        "ohne diese Kurve zeichnen",
    "line {} cannot be made drivable: near ({}, {}) m it goes back and forth: redraw the line without this turn":
        "Linie {0} ist nicht fahrbar: bei ({1}; {2}) m geht sie hin und zurück: die Linie ohne diese Kehre zeichnen",
    "curvature": "Krümmung",
    "curvature rate": "Änderung der Krümmung",
    "the path's tightest curve, {} 1/m, needs {} rad ({}°) of the front wheels, which vehicle.tractor_steering_limit "
    "= {} rad does not allow; raise it, or choose a path without curves as tight":
        "Die engste Kurve ({0} 1/m) braucht {2}° der Vorderräder ({1} rad), erlaubt sind {3} rad; unter Einrichten "
        "mehr erlauben, oder eine Linie ohne so enge Kurven wählen",
    "the path's curves need {} rad/s of the front wheels at {} m/s to stay within {} m (guidance.path_tolerance); "
    "vehicle.tractor_steering_rate = {} rad/s is too slow: raise it, or lower speed":
        "Die Kurven brauchen bei {1} m/s {0} rad/s der Vorderräder, um {2} m einzuhalten; {3} rad/s sind zu langsam: "
        "unter Einrichten schnelleres Lenken erlauben, oder langsamer fahren",
    "path.radii holds {} m; the vehicle turns no tighter than {} m, by vehicle.curvature_limit = {} 1/m":
        "Die Linie hat einen Radius von {0} m; das Fahrzeug fährt keinen engeren als {1} m: unter Einrichten einen "
        "kleineren erlauben, oder eine andere Linie wählen",
    "the tractor's receiver has no RTK-fixed position now; wait for one":
        "Der Empfänger des Traktors hat jetzt keinen RTK-Fix; darauf warten",
    "the antenna is not above the rear axle, and where the tractor faces is not known; drive on":
        "Die Antenne steht nicht über der Hinterachse, und wohin der Traktor zeigt, ist unbekannt; weiterfahren",
    # what is kept
    "{}: has no field {}; its fields are: {}": "{0}: hat kein Feld {1}; vorhanden sind: {2}",
    "{}: the field cannot be kept there ({})": "{0}: das Feld lässt sich dort nicht speichern ({1})",
    "{}: cannot be written ({}); nothing was changed": "{0}: nicht geschrieben ({1}); nichts wurde geändert",
    "the vehicle is steered now; stop first, then save":
        "Das Fahrzeug wird gerade gelenkt; zuerst anhalten, dann speichern",
    "{}: cannot be read ({})": "{0}: nicht lesbar ({1})",
    "{}: cannot be read ({}); {}": "{0}: nicht lesbar ({1})",
    "{}: holds no {}, which a log begins with{}; it was cut off in its beginning, or is no log of drawbar; {}":
        "{0}: enthält nicht {1}, womit eine Aufzeichnung beginnt{2}; sie wurde am Anfang abgeschnitten, oder ist keine "
        "von drawbar",
    "{}: is a pipe or a device, not a file; {}": "{0}: ist eine Pipe oder ein Gerät, keine Datei",
    "{}: is damaged, or no log of drawbar ({}); {}": "{0}: ist beschädigt oder keine Aufzeichnung von drawbar ({1})",
    "it is empty, as a full disk or a power cut leaves one":
        "sie ist leer, wie eine volle Platte oder ein Stromausfall sie hinterlässt",
    "it does not begin as an MCAP file does": "sie beginnt nicht wie eine MCAP-Datei",
    "a chunk does not match its checksum": "die Prüfsumme eines Abschnitts stimmt nicht",
    "a chunk has another length than it states": "ein Abschnitt hat nicht die Länge, die er angibt",
    "a chunk is compressed by {}, which drawbar does not write":
        "ein Abschnitt ist mit {0} gepackt, was drawbar nie schreibt",
    "its steps lack {}, which this drawbar needs; use the drawbar that wrote it":
        "ihren Schritten fehlt {0}, was dieses drawbar braucht; das drawbar verwenden, das sie geschrieben hat",
    "a step has {} bytes instead of {}": "ein Schritt hat {0} Byte anstatt {1}",
    "no step has {} bytes": "kein Schritt hat {0} Byte",
    "a StepRecord of numbers and arrays is needed; {}.": "ein StepRecord aus Zahlen und Feldern ist nötig; {0}.",
    "{} holds {} numbers instead of {}": "{0} enthält {1} Zahlen anstatt {2}",
    "it is not known where on Earth the path of this log lies: figure-eights and CSV files do not say. Export --csv "
    "instead, or drive a line that was recorded with its place":
        "Die Linie dieser Fahrt hat keinen Ort auf der Erde: Achten und CSV-Dateien haben keinen. Als CSV exportieren",
    "No space left on device": "kein Platz mehr auf dem Speicher",
    "Permission denied": "keine Erlaubnis",
    "Read-only file system": "der Speicher ist schreibgeschützt",
    "No such file or directory": "nicht vorhanden",
    "Is a directory": "ein Ordner",
    "Input/output error": "der Speicher ist gestört",
    # devices
    "port {} is taken: another program{} listens there; stop it or give another port":
        "Port {0} ist belegt: ein anderes Programm{1} hört dort zu; es beenden oder einen anderen Port angeben",
    "{} is no address of this computer; give one of its own, or 0.0.0.0 for all of them":
        "{0} ist keine Adresse dieses Rechners; eine seiner eigenen angeben, oder 0.0.0.0 für alle",
    "cannot listen on {}:{}: {}": "an {0}:{1} kann nicht gehört werden: {2}",
    "recording {}: is no file; a serial line is written serial:{}@115200":
        "Aufzeichnung {0}: ist keine Datei; eine serielle Leitung schreibt man serial:{1}@115200",
    "recording {}: cannot be read ({})": "Aufzeichnung {0}: nicht lesbar ({1})",
    # configuration
    "{}: 1 wrong value.": "{0}: 1 falscher Wert.",
    "{}: {} wrong values.": "{0}: {1} falsche Werte.",
    "{} with --set {}": "{0}",
    "  {}{}: {}.": "  {0}{1}: {2}.",
    "{}: is not valid TOML: {}.": "{0}: ist kein gültiges TOML ({1}).",
    "{}: cannot be read as a configuration ({}); give a TOML file or one of: {}.":
        "{0}: ist keine lesbare Konfiguration ({1}).",
    "{}: is neither a file nor a shipped configuration{}; give a TOML file or one of: {}.":
        "{0}: ist weder eine Datei noch eine mitgelieferte Konfiguration; mitgeliefert sind: {2}.",
    "{}: byte {} is not UTF-8 text; save the file as UTF-8.":
        "{0}: Byte {1} ist kein Text (UTF-8); die Datei als UTF-8 speichern.",
    "{}: extends = {} is not allowed; give the name of a shipped configuration ({}) or of a file in the same folder, "
    "but none that extends this one.":
        "{0}: extends = {1} ist nicht erlaubt; eine mitgelieferte Konfiguration nennen ({2}) oder eine Datei im "
        "selben Ordner, die nicht auf dieser aufbaut.",
    "has no key {}; its keys are: {}": "kennt {0} nicht; bekannt sind: {1}",
    "{}a number must be 0, or from {} to {} with either sign":
        "{0}eine Zahl muss 0 sein oder auf einer Seite davon {1} bis {2}",
    "{} m is higher than an antenna stands, {} m; feet? {} ft = {} m":
    "{} m ist höher, als eine Antenne steht, {} m; Fuß? {} ft = {} m",
    "{} is not a length in metres up to {} m; {} cm = {} m, {} mm = {} m":
        "{0} m ist zu lang, höchstens {1} m; {2} cm = {3} m, {4} mm = {5} m",
    "{} is not an angle in radians within ±π; degrees? {}° = {} rad":
        "{0} rad ist kein Winkel innerhalb von ±180°; sind das Grad? {1}° = {2} rad",
    "{} is not a speed in m/s up to {} m/s; km/h? {} km/h = {} m/s":
        "{0} m/s ist zu schnell, höchstens {1} m/s; sind das km/h? {2} km/h = {3} m/s",
    "{} is not a delay in seconds up to {} s; ms? {} ms = {} s":
        "{0} s ist keine Verzögerung bis {1} s; sind das Millisekunden? {2} ms = {3} s",
    "trailer_antenna = {} m is ahead of the actuated joint; it must be at most trailer_length = {} m":
        "der geführte Punkt, {0} m vor der Achse, liegt vor dem Lenkgelenk; höchstens {1} m, Lenkgelenk bis Achse",
    "tracked.trailer.left = {} m is {} m beside tracked.tractor.left = {} m; the trailer's steering reaches "
    "drawbar_length sin(trailer_steering_limit) = {} m to either side: bring them nearer to each other, so that the "
    "tractor runs beside the line too":
        "der geführte Punkt des Anhängers, {0} m links, liegt {1} m neben dem des Traktors, {2} m links; die Lenkung "
        "des Anhängers reicht {3} m zur Seite: beide näher zueinander legen, dann fährt auch der Traktor neben der "
        "Linie",
    "drawbar_length = {} m puts the free joint ahead of the front axle; it must be below hitch_length + wheelbase = "
    "{} m":
        "Kupplung bis Lenkgelenk, {0} m, legt die Kupplung vor die Vorderachse; es muss kürzer als {1} m sein",
    "speed = {} m/s is above machine.hydrostat.full_speed = {} m/s; lower it, or raise the other where the machine is "
    "faster":
        "Fahrtempo {0} m/s ist schneller, als das simulierte Fahrzeug fahren kann, {1} m/s; senken, oder, wo die "
        "Maschine schneller ist, machine.hydrostat.full_speed erhöhen",
    "vehicle.{}_steering_limit = {} rad is beyond the machine's mechanical stop, machine.actuators.{}_stop = {} rad; "
    "lower it, or raise the other where the machine turns further":
        "der Lenkwinkel {1} rad liegt hinter dem Anschlag, {3} rad; senken, oder, wo die Maschine weiter lenkt, "
        "machine.actuators.{2}_stop erhöhen",
    "track = {} is given without a file; give path.file too, or leave track out":
        "Linie {0} ohne Datei; path.file auch angeben",
    "{} is too large against the weights on the errors: a correction would take {} s, at most {} s is allowed with "
    "controller.horizon = {} and sample_time = {} s; raise horizon (to {}) or sample_time, lower the weight, or raise "
    "the others":
        "{0} ist zu groß gegenüber den Gewichten der Fehler: eine Korrektur würde {1} s dauern, höchstens {2} s sind "
        "mit controller.horizon = {3} und sample_time = {4} s erlaubt; horizon (auf {5}) oder sample_time erhöhen, "
        "oder das Gewicht ändern",
    "speed = {} m/s drives the vehicle {} m in each sample_time = {} s, which is too far for vehicle.wheelbase = {} m: "
    "at most {} m is allowed; lower speed or sample_time, or correct the wheelbase":
        "mit {0} m/s fährt das Fahrzeug {1} m je sample_time = {2} s, zu weit für den Radstand von {3} m: höchstens "
        "{4} m sind erlaubt; Tempo oder sample_time senken, oder den Radstand richtigstellen",
    # why no corrections come
    "the caster {} ({}); {}": "der Caster {0} ({1}); {2}",
    "the caster {}; {}": "der Caster {0}; {1}",
    "the caster {}: {}": "der Caster {0}: {1}",
    "the caster {} has ended the stream": "der Caster {0} hat den Strom beendet",
    "the caster {} sends bytes, but no intact frame of RTCM 3; check devices.corrections.mount":
        "der Caster {0} schickt Bytes, aber keinen heilen Rahmen von RTCM 3; devices.corrections.mount prüfen",
    "the caster takes no bytes": "der Caster nimmt keine Bytes an",
    "sends its table of mount points instead of corrections":
        "schickt seine Liste der Mountpoints statt Korrekturen",
    "refuses the user name or the password": "lehnt Benutzernamen oder Passwort ab",
    "has no such mount point": "kennt diesen Mountpoint nicht",
    "refuses the request": "lehnt die Anfrage ab",
    "leads to another page": "verweist auf eine andere Seite",
    "answers something that is not NTRIP": "antwortet etwas, das nicht NTRIP ist",
    "check devices.corrections.mount": "devices.corrections.mount prüfen",
    "check what devices.corrections.credentials leads to": "prüfen, wohin devices.corrections.credentials führt",
    "check corrections.version, and ask the caster's operator":
        "corrections.version prüfen und den Betreiber des Casters fragen",
    "see whether the modem or its network asks for a login, else check devices.corrections.host":
        "nachsehen, ob das Modem oder sein Netz eine Anmeldung verlangt, sonst devices.corrections.host prüfen",
    "check devices.corrections.host, port and tls": "devices.corrections.host, port und tls prüfen",
    "no connection within {} s while {}": "keine Verbindung innerhalb von {0} s ({1})",
    "looking up the name": "beim Suchen des Namens",
    "connecting": "beim Verbinden",
    "agreeing on TLS": "beim Aushandeln von TLS",
    "no answer within {} s": "keine Antwort innerhalb von {0} s",
    "no byte for {} s; it may be waiting for a position, and the receiver has no fix":
        "{0} s lang kein Byte; vielleicht wartet er auf eine Position, und der Empfänger hat keinen Fix",
    "no byte for {} s": "{0} s lang kein Byte",
    "the name {} is not found ({})": "der Name {0} wird nicht gefunden ({1})",
    "the other end has closed the connection": "die Gegenstelle hat die Verbindung beendet",
    "the other end takes no more bytes": "die Gegenstelle nimmt keine Bytes mehr an",
    "Connection refused": "Verbindung abgelehnt",
    "Connection reset by peer": "Verbindung von der Gegenstelle abgebrochen",
    "Network is unreachable": "Netz nicht erreichbar",
    "No route to host": "kein Weg zu diesem Rechner",
}  # fmt: skip
