# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Results of the diagnosis on simulated machines for which it was not tuned.

``python -m bearing_twin.studies.generalisation [CASES] [twin|impacts] [FIRST]`` draws CASES random
machines from number FIRST (0) on. Numbers that were never drawn before are an independent test.
Machines of ``twin`` are simulated with the equations of motion; bearing, speed, sample rate, load,
slip, place and size of the defect are random. Machines of ``impacts`` share nothing with the twin:
they are trains of impacts with random slip, or noise modulated by them, through random resonances,
with the geometries, sample rates and lengths of known rigs. Both have an unknown sensor gain, an
inexact nameplate speed, and the vibration of other machinery. It prints tables of the answers by
true condition and by machine.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, TypeAlias

from bearing_twin.bearing import PLACES
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.studies import impact_machines, twin_machines
from bearing_twin.studies.disturbances import CONDITIONS
from bearing_twin.studies.output import arguments, print_table

if TYPE_CHECKING:
    from bearing_twin.diagnosis import Diagnosis
    import numpy as np
    from numpy.typing import NDArray


MODELS = ('twin', 'impacts')

Machine: TypeAlias = twin_machines.Case | impact_machines.Case


def outcome(case: Machine, said: Diagnosis) -> str:
    """Return ``right``, ``wrong`` (a fault that is not there), or the result if it is neither."""
    truth = () if case.condition == 'none' else (case.condition,)
    if said.result not in PLACES:
        return 'right' if said.result == 'healthy' and not truth else said.result
    return 'right' if said.faults == truth else 'wrong'


def judge_case(model: str, number: int, *, misled: bool = False) -> tuple[Machine, Diagnosis]:
    """Draw a machine and diagnose its record; ``misled`` as in :func:`impact_machines.draw`."""
    if model == 'twin':
        twin = twin_machines.draw(number)
        return twin, _diagnose(twin, twin_machines.record(twin))
    rig = impact_machines.draw(number, misled=misled)
    return rig, _diagnose(rig, impact_machines.record(rig))


def _diagnose(case: Machine, x: NDArray[np.float64]) -> Diagnosis:
    return diagnose_record(x, case.sample_rate, case.geometry, case.given_hz)


def study(cases: Iterable[int], model: str = 'twin') -> list[tuple[Machine, Diagnosis]]:
    """Diagnose each case."""
    return [judge_case(model, number) for number in cases]


def main(argv: Sequence[str] | None = None) -> None:
    """Print the answers by condition and by machine."""
    parser = arguments(__name__, cases=600)
    parser.add_argument('model', choices=MODELS, nargs='?', default='twin')
    parser.add_argument('first', type=int, nargs='?', default=0)
    args = parser.parse_args(argv)
    found = study(range(args.first, args.first + args.cases), args.model)
    answers = ('right', 'wrong', 'suspect', 'ambiguous', 'insufficient', 'healthy')
    machines = sorted({case.machine for case, _ in found})
    for kind, names in (('condition', CONDITIONS), ('machine', machines)):
        told = {
            name: Counter(outcome(c, said) for c, said in found if getattr(c, kind) == name)
            for name in names
        }
        print_table(
            (kind, 'cases', *answers),
            (
                (name, count.total(), *(count[answer] or '' for answer in answers))
                for name, count in told.items()
            ),
        )
        print()
    for case, said in found:
        if outcome(case, said) == 'wrong':
            print(f'- {case}: {said.reasons}')


if __name__ == '__main__':
    main()
