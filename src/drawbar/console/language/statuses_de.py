"""Statuses in German: with which one the controller's run has ended."""

from collections.abc import Mapping

from drawbar.statuses import Status

STATUSES_DE: Mapping[Status, str] = {
    Status.FINISHED: "der Traktor hat das Ende der Linie erreicht",
    Status.OFF_COURSE: "der Traktor ist zu weit von der Linie",
    Status.BLIND: "keine der beiden Antennen hatte lange genug eine gültige Position",
    Status.GUIDANCE: "die Schätzung ist keine Zahl, oder kein Bogen führt auf die Linie zurück",
    Status.GAP: "länger, als ein Befehl wiederholt werden darf, kamen keine Messungen",
    Status.STOPPED: "länger, als einer wiederholt werden darf, kam kein neuer Befehl",
    Status.UNSOLVED: "Schätzer oder Regler hatten zu lange keine Lösung",
    Status.OVERDUE: "Messungen kamen zu lange zu spät",
    Status.RATE: "Messungen kommen öfter oder seltener, als die Abtastzeit sagt",
    Status.COARSE: "die Positionen waren zu lange ungenau",
    Status.OSCILLATION: "Abstand oder Lenkung schwingen von einer Seite zur anderen",
    Status.BACKWARDS: "beide Antennen bewegen sich rückwärts: sie sind vertauscht, oder das Fahrzeug fährt rückwärts",
    Status.STEERING: "eine Lenkung folgt ihren Befehlen nicht: Sensor oder Antrieb ist defekt, oder jemand lenkt",
    Status.HITCH: "der Knickwinkel widerspricht der Bewegung von Traktor und Anhänger",
    Status.ROLL: "ein Neigungssensor widerspricht anderen Winkeln oder seiner Antenne: verkehrt herum oder verklemmt",
    Status.JUMPED: "beide Positionen springen: Basisstation oder Lösung hat gewechselt, oder das Gespann rutscht",
}
