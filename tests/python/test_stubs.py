"""The stubs list what the module has, and each part of the module says what it is."""
import ast
import pathlib

import cartvo.lcm
from cartvo import _cartvo

STUBS = ast.parse((pathlib.Path(cartvo.__file__).parent / "_cartvo.pyi").read_text())


def names_in(body):
    names = {node.name for node in body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    names |= {node.target.id for node in body if isinstance(node, ast.AnnAssign)}
    names |= {target.id for node in body if isinstance(node, ast.Assign) for target in node.targets}
    return names


def public_names(thing):
    return {name for name in vars(thing) if not name.startswith("_")}


def test_stubs_list_each_name():
    stubbed = names_in(STUBS.body)
    assert {name for name in stubbed if not name.startswith("_")} == public_names(_cartvo)
    for node in STUBS.body:
        if isinstance(node, ast.ClassDef):
            expected = public_names(getattr(_cartvo, node.name))
            listed = {name for name in names_in(node.body) if not name.startswith("_")}
            assert listed == expected, node.name


def test_the_package_gives_each_name():
    assert set(cartvo.__all__) | set(cartvo.lcm.__all__) == public_names(_cartvo) | {"__version__"}


def test_each_class_and_function_has_a_text():
    for name in public_names(_cartvo):
        thing = getattr(_cartvo, name)
        assert thing.__doc__, name
        if isinstance(thing, type) and name not in ("Status", "Estimator", "RigRefinement", "CameraState"):
            methods = [member for member in public_names(thing) if callable(getattr(thing, member))]
            for method in methods:
                assert getattr(thing, method).__doc__, f"{name}.{method}"
