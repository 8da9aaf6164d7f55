"""Race: peers solve the stage problems of a solver at work; it notes how long each took and whether they agree."""

from dataclasses import dataclass, field

from drawbar.benchmark.hostile.construct import HostileProblem
from drawbar.benchmark.hostile.verdict import Answer, Verdict, judge
from drawbar.benchmark.peers.base import MissingPeerError, Peer, stage_problem
from drawbar.benchmark.peers.daqp import Daqp
from drawbar.benchmark.peers.hpipm import Hpipm
from drawbar.benchmark.peers.piqp import Piqp
from drawbar.codegen import Workspace
from drawbar.geometry import Floats
from drawbar.optimal.stage_problem import StageProblem

PEERS: tuple[type[Peer], ...] = (Hpipm, Daqp, Piqp)


@dataclass(slots=True, kw_only=True)
class Times:
    """What one solver took for the problems it was given, s."""

    free: list[float] = field(default_factory=list)
    """without a bound active"""
    active: list[float] = field(default_factory=list)
    """with bounds active"""
    others: int = 0
    """problems of which it found another answer than drawbar, or none"""

    def add(self, time: float, *, bounded: bool) -> None:
        """Note one problem."""
        (self.active if bounded else self.free).append(time)


class Race:
    """All peers on the problems of one structure."""

    def __init__(self, *, free_initial: bool) -> None:
        """Take whether the first state is a variable; peers are made when the first problem comes."""
        self._free_initial = free_initial
        self._peers: list[Peer] | None = None
        self.times: dict[str, Times] = {}
        """by the name of the solver"""
        self.missing: dict[str, str] = {}
        """why a peer is left out, by its name"""

    def run(self, workspace: Workspace, own_time: float) -> None:
        """Give the problem that drawbar has just solved, in so many seconds, to all peers."""
        problem, z = stage_problem(workspace, free_initial=self._free_initial), workspace.array("qp.z").copy()
        bounded = bool(workspace.array("qp.iterations")[0])
        if self._peers is None:
            self._peers = self._made(problem)
        self.times.setdefault("drawbar", Times()).add(own_time, bounded=bounded)
        for peer in self._peers:
            times = self.times.setdefault(peer.name, Times())
            time, answer = peer.solve(problem)
            times.add(time, bounded=bounded)
            times.others += not same(problem, z, answer)

    def _made(self, problem: StageProblem) -> list[Peer]:
        made = []
        for peer in PEERS:
            try:
                made.append(peer(problem))
            except MissingPeerError as error:
                self.missing[peer.name] = str(error)
        return made


def same(problem: StageProblem, z: Floats, answer: Floats) -> bool:
    """Return whether an answer (NZ,) is as good as z (NZ,): violates nothing and costs the same, to a millionth."""
    truth = HostileProblem(name="recorded", problem=problem, optimum=z)
    return judge(truth, Answer(claim=Verdict.SOLVED, z=answer)) == Verdict.SOLVED
