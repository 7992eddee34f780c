# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
import ast
import os
from pathlib import Path
import resource

from bearing_twin.numerics.compiled import processor, SHARED
from cases import in_proofs
from commands import python
import pytest

ROOT = Path(__file__).parents[2]
PACKAGE = 'bearing_twin/numerics'

# A compiled function calls one of another file, as the kernels do.
RUN = """
from bearing_twin.numerics import compiled
from bearing_twin.numerics.caller import outer
print(compiled.cache_folder(), outer(1.0))
"""
CALLER = """
from bearing_twin.numerics.callee import inner
from bearing_twin.numerics.compiled import compiled

@compiled()
def outer(x):
    return inner(x)
"""
CALLEE = """
from bearing_twin.numerics.compiled import compiled

@compiled()
def inner(x):
    return x + {}
"""


@pytest.fixture
def tree(tmp_path):
    """Only the compilation, with two small files as kernels."""
    folder = tmp_path / 'tree' / PACKAGE
    folder.mkdir(parents=True)
    (tmp_path / 'tree/bearing_twin/__init__.py').touch()
    (folder / '__init__.py').touch()
    (folder / 'compiled.py').write_bytes((ROOT / PACKAGE / 'compiled.py').read_bytes())
    (folder / 'caller.py').write_text(CALLER)
    (folder / 'callee.py').write_text(CALLEE.format('1.0'))
    return tmp_path / 'tree'


def run(tree, **environment):
    inherited = {k: v for k, v in os.environ.items() if k not in ('NUMBA_CACHE_DIR', 'PYTHONPATH')}
    given = inherited | {key: str(value) for key, value in environment.items()}
    done = python('-B', '-c', RUN, cwd=tree, env=given, check=True)
    folder, value = done.stdout.split()
    return folder, float(value)


@pytest.mark.parametrize('where', ['beside the sources', *in_proofs('named', 'at home')])
def test_a_change_in_a_called_file_is_seen_wherever_the_cache_lies(tree, tmp_path, where):
    cache, environment = tree / PACKAGE / '__pycache__', {}
    if where == 'named':
        cache = tmp_path / 'named'
        environment = {'NUMBA_CACHE_DIR': cache}
    elif where == 'at home':
        cache.touch()  # a file where the folder should be: nothing can be written, not by root
        cache = tmp_path / 'home'
        environment = {'XDG_CACHE_HOME': cache}
    folder, value = run(tree, **environment)
    assert value == 2.0
    assert Path(folder).parent == cache
    assert list(Path(folder).rglob('*.nbi'))
    assert run(tree, **environment) == (folder, 2.0)
    (tree / PACKAGE / 'callee.py').write_text(CALLEE.format('2.0'))
    other, value = run(tree, **environment)
    assert (other != folder, value) == (True, 3.0)


def names(*nodes):
    return {n.id for node in nodes for n in ast.walk(node) if isinstance(n, ast.Name)}


def taken_by_compiled_code(tree):
    """Return where names come from that compiled functions of a module use, however derived."""
    taken, made, asked = {}, {}, set()
    for node in tree.body:
        if isinstance(node, ast.ImportFrom) and node.module.startswith('bearing_twin'):
            folder = ROOT.joinpath(*node.module.split('.'))
            taken |= {alias.asname or alias.name: folder / alias.name for alias in node.names}
        elif isinstance(node, (ast.Assign, ast.AnnAssign)) and node.value:
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            made |= dict.fromkeys(names(*targets), names(node.value))
        elif isinstance(node, ast.FunctionDef):
            made[node.name] = names(*node.body)
            if 'compiled(' in ''.join(map(ast.unparse, node.decorator_list)):
                asked.add(node.name)
    used = set()
    while asked:
        used |= asked
        asked = set().union(*(made.get(name, ()) for name in asked)) - used
    return [taken[name] for name in used & taken.keys()]


def test_files_from_which_compiled_code_of_others_takes_anything_are_in_the_folders_name():
    known = {path for pattern in SHARED for path in (ROOT / 'bearing_twin').glob(pattern)}
    for path in (ROOT / 'bearing_twin').rglob('*.py'):
        for name in taken_by_compiled_code(ast.parse(path.read_text())):
            module, own = name.with_suffix('.py'), name.parent.with_suffix('.py')
            assert {module, own, name.parent / '__init__.py'} & known, (path, name)


def test_numbers_that_follow_from_those_of_another_file_are_taken_from_it_too():
    source = """
from bearing_twin.diagnosis.thresholds import HARMONICS, SLIP, Z_FAULT
HALF = HARMONICS / 2
def last(x): return x[HALF]
@compiled()
def inner(x): return last(x) > Z_FAULT
def outer(x): return inner(x) + SLIP
"""
    found = {name.name for name in taken_by_compiled_code(ast.parse(source))}
    assert found == {'HARMONICS', 'Z_FAULT'}


@pytest.mark.parametrize('variable', ['NUMBA_CACHE_DIR', *in_proofs('XDG_CACHE_HOME')])
def test_where_no_cache_can_be_written_it_runs_all_the_same(tree, variable):
    (tree / PACKAGE / '__pycache__').touch()
    assert run(tree, **{variable: '/dev/null/cache'}) == ('None', 2.0)


def small_files():
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))


def test_a_cache_without_room_costs_one_warning_and_no_result(tree, tmp_path):
    given = os.environ | {'NUMBA_CACHE_DIR': str(tmp_path / 'cache'), 'PYTHONPATH': ''}
    done = python('-B', '-c', RUN, cwd=tree, env=given, preexec_fn=small_files)
    assert (done.returncode, done.stdout.split()[1]) == (0, '2.0')
    folder = done.stdout.split()[0]
    assert done.stderr == (
        f'compiled code cannot be kept in {folder} (File too large): each start compiles it '
        'again; make room, or set NUMBA_CACHE_DIR to another folder\n'
    )
    assert run(tree, NUMBA_CACHE_DIR=tmp_path / 'cache') == (folder, 2.0)


def test_compiling_for_later_without_room_is_an_error(tmp_path):
    script = (
        'from bearing_twin.cli import compile, main\n'
        'from bearing_twin.thermal.network import clearance_change\n'
        'from bearing_twin.numerics.compiled import compiled\n'
        # One small function instead of all.
        'warm = compiled()(clearance_change)\n'
        'compile.dynamics.warm_up = lambda fleet: warm(60.0, 40.0, 0.05735)\n'
        'compile.diagnosis.warm_up = lambda: None\n'
        "raise SystemExit(main(['compile']))\n"
    )
    given = os.environ | {'NUMBA_CACHE_DIR': str(tmp_path)}
    done = python('-B', '-c', script, env=given, preexec_fn=small_files)
    assert (done.returncode, done.stdout) == (1, '')
    assert done.stderr.splitlines()[-1].startswith('bearing-twin compile: compiled code cannot')


def test_a_killed_process_of_compile_is_an_error():
    script = (
        'import os, signal\n'
        'from bearing_twin.cli import compile, main\n'
        'compile.dynamics.warm_up = lambda fleet: None\n'
        'compile.diagnosis.warm_up = lambda: os.kill(os.getpid(), signal.SIGKILL)\n'
        "raise SystemExit(main(['compile']))\n"
    )
    done = python('-c', script)
    assert (done.returncode, done.stdout) == (1, '')
    assert done.stderr == (
        'bearing-twin compile: the process that compiled the diagnosis was killed; leave it more '
        'memory\n'
    )


@pytest.mark.parametrize('damages', [('cut', 'a folder'), *in_proofs((('empty', 'other bytes'),))])
def test_a_damaged_cache_is_made_anew(tree, tmp_path, damages):
    cache = tmp_path / 'cache'
    folder, _ = run(tree, NUMBA_CACHE_DIR=cache)
    for damage in damages:
        seen = {file: file.read_bytes() for file in Path(folder).rglob('*.nb?')}
        assert len(seen) == 4
        for file, whole in seen.items():
            if damage == 'a folder':
                file.unlink()
                file.mkdir()
            else:
                cut = whole[: len(whole) // 2]
                file.write_bytes({'empty': b'', 'cut': cut, 'other bytes': whole[::-1]}[damage])
        assert run(tree, NUMBA_CACHE_DIR=cache) == (folder, 2.0), damage
        if damage != 'a folder':
            seen = {file: file.read_bytes() for file in Path(folder).rglob('*.nb?')}
            assert run(tree, NUMBA_CACHE_DIR=cache) == (folder, 2.0)
            assert {file: file.read_bytes() for file in Path(folder).rglob('*.nb?')} == seen


@pytest.mark.skipif(processor() == 'generic', reason='LLVM does not know this processor')
def test_code_for_another_processor_is_named_and_not_used(tmp_path):
    cache = tmp_path / 'cache'
    environment = os.environ | {'NUMBA_CACHE_DIR': str(cache)}
    script = (
        'from bearing_twin.numerics import compiled\n'
        'from bearing_twin.thermal.network import clearance_change\n'
        'from bearing_twin.numerics.compiled import other_processors, processor\n'
        'others = other_processors()\n'
        'change = round(1e6 * compiled.compiled()(clearance_change)(60.0, 40.0, 0.05735), 2)\n'
        'print(processor(), *others, change, compiled.has_compiled())\n'
    )

    def call(**more):
        return python('-c', script, env=environment | more, check=True).stdout.split()

    other = call(NUMBA_CPU_NAME='generic', NUMBA_CPU_FEATURES='')
    assert other == ['generic', '-6.88', 'True']
    name, *named, value, anew = call()
    assert (named, value, anew) == (['generic'], '-6.88', 'True')
    assert name != 'generic'
    assert call() == [name, '-6.88', 'False']
