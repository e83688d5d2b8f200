"""What is tested of JAX's arrays on the processor and on a GPU alike. The test sets JAX up before it imports this."""
import importlib
import pickle
import pydoc
import sys
import threading
from pathlib import Path
from types import SimpleNamespace

from support import SEED, error_of, exhaustive, need, package, refused, robot_file, skip

rneagen, np = package()
jax, = need("jax")
try:
    import rneagen.jax
except rneagen.Error as error:
    skip(str(error))
if not rneagen.jax._jax_operator._core.xla_handlers():
    skip("the package was built without XLA's header")
import jax.numpy as jnp
from jax.sharding import NamedSharding, PartitionSpec
from jax.test_util import check_grads

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "bench" / "peers"))
import model
import spatial

jax.config.update("jax_enable_x64", True)
jax.config.update("jax_default_matmul_precision", "highest")
LIMITS = {"float32": 2e-4, "float64": 1e-11}
shard_map = getattr(jax, "shard_map", None) or importlib.import_module("jax.experimental.shard_map").shard_map
compiled = []
jax.monitoring.register_event_duration_secs_listener(
    lambda event, *rest, **more: compiled.append(event) if "backend_compile" in event else None)


def load(name, **scene):
    return rneagen.load(robot_file(name), **scene)


def arrays(robot, n=None, dtype="float64"):
    return [jnp.asarray(x) for x in robot.random(n, seed=SEED, dtype=dtype)]


def reference(name, library=jnp):
    """Torques of another algorithm, which reads the URDF by itself, operation by operation: with JAX's, JAX differentiates it."""
    return spatial.Spatial(library, model.Model(robot_file(name)), lambda x: library.asarray(x, "float64")).function("rnea")


def near(a, b, limit=1e-10):
    return a.shape == b.shape and bool(jnp.abs(a - b).max() <= limit * (1 + jnp.abs(b).max()))


def unit(robot, q):
    """q with unit quaternions."""
    for joint in robot.joints:
        if joint["nq"] != joint["nv"]:
            i = joint["iq"] + 3
            q = jnp.concatenate([q[..., :i], q[..., i:i + 4] / jnp.linalg.norm(q[..., i:i + 4], axis=-1, keepdims=True),
                                 q[..., i + 4:]], -1)
    return q


def check_gradient(name, **scene):
    """Forward and backward, beside differences; freed constants are drawn too, which the scene's own draw leaves at the
    URDF's."""
    robot, draw = load(name, **scene), np.random.default_rng(SEED)
    x = [jnp.asarray(draw.normal(size=a.shape if a.per_batch else (2, *a.shape))) for a in robot.inputs]
    at = [a.role for a in robot.inputs].index("joint_position")
    check_grads(jax.jit(lambda *x: robot(*(unit(robot, y) if i == at else y for i, y in enumerate(x)))), x, 1, ("fwd", "rev"))


# ---- cases ----


def case_values():
    """Beside the reference, any leading shape, both dtypes, inside of jit and outside."""
    for dtype, limit in LIMITS.items():
        robot = load("iiwa14")
        x = arrays(robot, 60, dtype)
        tau = robot(*x)
        right = reference("iiwa14", np)(*(np.asarray(y, "float64") for y in x))
        assert isinstance(tau, jax.Array) and tau.dtype == dtype and error_of(np, np.asarray(tau), right) < limit
        assert jnp.array_equal(jax.jit(robot)(*x), tau)
        assert jnp.array_equal(robot(*(y.reshape(3, 20, -1) for y in x)).reshape(tau.shape), tau)
        assert near(robot(*(y[3] for y in x)), tau[3], limit)
        assert jnp.array_equal(robot(x[0], qdd=x[2], qd=np.asarray(x[1])), tau)
        assert robot(*(y[:0] for y in x)).shape == (0, 7) and jax.jit(robot)(*(y[:0] for y in x)).dtype == dtype
        both = jax.jit(robot.want("M", "bias"))(*x[:2])
        assert both._fields == ("M", "bias") and near(both.bias, robot(x[0], x[1], 0 * x[2]), limit)
        assert near(jnp.einsum("kij,kj->ki", both.M, x[2]) + both.bias, tau, limit)
        qdd = load("iiwa14", want="qdd")(x[0], x[1], tau)
        assert error_of(np, np.asarray(qdd), np.asarray(x[2])) < 100 * limit
    for name, base in (("mimic_chain", "fixed"), ("cartpole", "floating")):
        robot = load(name, base=base)
        x = arrays(robot, 20)
        assert error_of(np, np.asarray(robot(*x)), robot(*map(np.asarray, x))) < 1e-11


def case_derivatives():
    """Beside those that JAX makes of the reference."""
    for name in ("cartpole", *(("iiwa14", "ur5") if exhaustive() else ())):
        robot, other = load(name), reference(name)
        x, d = arrays(robot, 5), [y[3:] for y in arrays(robot, 8)]
        for one in (lambda f: jax.grad(lambda *x: (f(*x) ** 2).sum(), (0, 1, 2))(*x), lambda f: jax.jvp(f, x, d)):
            for found, right in zip(jax.tree.leaves(one(robot)), jax.tree.leaves(one(other))):
                assert near(found, right), name
        right = jax.vmap(jax.jacfwd(other))(*x)
        assert near(jax.vmap(jax.jacfwd(robot))(*x), right) and near(jax.jit(jax.vmap(jax.jacrev(robot)))(*x), right), name


def case_gradients():
    """In f64: fixed bases, joints that follow, floating bodies, constants that are inputs, wrenches."""
    check_gradient("mimic_chain")
    check_gradient("cartpole", base="floating")
    check_gradient("root_with_mass", base="floating", want="qdd")
    unread = {"want": "qdd", "fold": {"tau.elbow": 0}}  # a row, for which nothing is copied
    check_gradient("double_pendulum", **unread)
    assert len(jax.make_jaxpr(robot := load("double_pendulum", **unread))(*arrays(robot, 2)).eqns) == 1
    arm = {"free": ["gravity", "payload.lower", "mass.upper:sample", "inertia.lower", "offset.shoulder"], "fext": ["lower"],
           "damping": True}
    check_gradient("double_pendulum", **arm)
    check_gradient("double_pendulum", want=["M", "bias", "gravity", "tau"], **arm)
    check_gradient("double_pendulum", want="qdd", free=["armature", "damping:sample", "friction.elbow"], friction=0.1)
    if exhaustive():
        check_gradient("floating_joint")
        check_gradient("double_pendulum", want="qdd", **arm)
        check_gradient("double_pendulum", base="floating", fext=["lower"])
        check_gradient("double_pendulum", want=["qdd", "M", "bias"], refine="1", dynamics="factor")
        check_gradient("planar_joint")
        check_gradient("cartpole", want=["M", "bias", "gravity", "tau"], damping=True, friction=0.1)
        check_gradient("iiwa14", want=["qdd"], free=["payload.iiwa_link_7"])
        check_gradient("hyq", base="floating", free=["payload.lf_foot:batch", "gravity"], fext=["rf_foot"])


def case_gradients_of_sets():
    """In f64, forward and backward, of poses and of several outputs at once, some of them matrices; freed constants and wrenches
    too."""
    arm = {"free": ["gravity", "payload.lower", "mass.upper:sample", "offset.shoulder"], "fext": ["lower"], "damping": True}
    check_gradient("double_pendulum", want=["qdd", "pose.lower", "kinetic", "accel.lower"], fext_frame="world", **arm)
    check_gradient("cartpole", base="floating", want=["pose.pole", "com", "momentum", "tau"], pose="quaternion")
    if exhaustive():
        check_gradient("double_pendulum", want=["tau", "pose.lower"], **arm)
        check_gradient("mimic_chain", want=["pose.pinion", "jacobian.pinion", "regressor"])
        check_gradient("double_pendulum", want=["kinetic", "potential", "power", "twist.lower", "accel.lower"], **arm)
        check_gradient("root_with_mass", base="floating", want=["qdd", "momentum_matrix", "djacobian.leg"], frame="world-aligned")
        check_gradient("planar_joint", want=["com", "momentum", "dtau_dq"])
        check_gradient("iiwa14", want=["tau", "pose.iiwa_link_7", "jacobian.iiwa_link_7"], free=["payload.iiwa_link_7"])


def case_one_sweep():
    """Derivatives of two outputs are made by one text, and those of one output by a text of that alone, forward too. What fold=
    makes constant has none."""
    robot = load("double_pendulum", want=["tau", "pose.lower"], gravity=(0, 1, -9))
    x, made = arrays(robot, 4), rneagen.jax._jax_operator.operator_of(robot).gradients.made

    def tau(*x):
        return (robot(*x).tau ** 2).sum()

    def place(*x):
        return robot(*x).pose_lower[..., 3].sum()

    def whole(*x):
        both = robot(*x)
        return (both.tau ** 2).sum() + both.pose_lower[..., 3].sum()

    once = jax.grad(whole)(*x)
    assert list(made) == [("vjp", ("tau", "pose.lower"), ())]
    assert near(once, jax.grad(tau)(*x) + jax.grad(place)(*x)) and len(made) == 3
    jax.jit(lambda q: jax.jvp(lambda q: place(q, *x[1:]), (q,), (q,)))(x[0])
    assert list(made)[3:] == [("jvp", ("pose.lower",), ())]
    still = load("double_pendulum", want=["kinetic", "tau"], fold={"qd": 0})
    assert not jax.grad(lambda q: still(q, x[2]).kinetic.sum())(x[0]).any()
    along = jax.jvp(lambda q: still(q, x[2]), (x[0],), (x[1],))[1]
    at_rest = load("double_pendulum", fold={"qd": 0})
    assert not along.kinetic.any() and near(along.tau, jax.jvp(lambda q: at_rest(q, x[2]), (x[0],), (x[1],))[1])


def case_left_out():
    robot = load("double_pendulum", free=["gravity", "payload.lower"])
    q, qd, qdd = arrays(load("double_pendulum"), 5)
    right, down = load("double_pendulum")(q, qd, qdd), jnp.array([0, 0, -9.81])
    assert near(robot(q, qd, qdd), right) and near(robot(q, qd, qdd, gravity=down), right)
    assert near(jax.jit(robot)(q, qd, qdd, None, jnp.zeros((5, 10))), right)
    assert near(jax.grad(lambda q: robot(q, qd, qdd).sum())(q), jax.grad(lambda q: load("double_pendulum")(q, qd, qdd).sum())(q))


def case_precisions():
    """float32, and the arithmetic that differs from what is in memory."""
    plain = load("double_pendulum")
    x = arrays(plain, 8)
    right = jax.grad(lambda q: plain(q, *x[1:]).sum())(x[0])
    for precision, dtype, limit in (("f32", "float32", 1e-4), ("mixed", "float32", 1e-5), ("f32x2", "float64", 1e-10)):
        robot, y = load("double_pendulum", precision=precision), [z.astype(dtype) for z in x]
        found = jax.grad(lambda q: robot(q, *y[1:]).sum())(y[0])
        assert found.dtype == dtype and near(found.astype("float64"), right, limit), precision


def case_vmap():
    """One more axis of samples, without a loop: as one call in XLA's program."""
    robot = load("double_pendulum", free=["payload.lower:batch"])
    q, qd, qdd, held = arrays(robot, 12)
    tau, (a, b, c) = robot(q, qd, qdd), (x.reshape(3, 4, 2) for x in (q, qd, qdd))
    assert near(jax.vmap(robot)(q, qd, qdd), tau)
    assert near(jax.vmap(jax.vmap(robot))(a, b, c).reshape(12, 2), tau)
    assert near(jax.vmap(jax.vmap(robot, (0, 0, 0)), (1, 1, 1), 1)(a, b, c).reshape(12, 2), tau)
    assert near(jax.vmap(robot, (0, None, None))(q, qd[0], qdd[0])[0], tau[0])
    assert near(jax.vmap(robot, (1, 0, 0))(q.T, qd, qdd), tau)
    text = jax.jit(jax.vmap(jax.vmap(robot))).lower(a, b, c).as_text()
    assert text.count("custom_call @rneagen") == 1 and "while" not in text
    by_held = jax.vmap(lambda q, qd, qdd: jax.jacfwd(lambda p: robot(q, qd, qdd, p))(held))(q, qd, qdd)
    assert near(by_held, load("double_pendulum", free=["payload.lower:batch"], want="dtau_dpayload.lower")(q, qd, qdd, held))
    assert near(jax.vmap(lambda q, qd, qdd: jax.jacrev(lambda p: robot(q, qd, qdd, p))(held))(q, qd, qdd), by_held)
    both = load("double_pendulum", free=["gravity", "offset.shoulder"], want=["tau", "pose.lower"])
    q, qd, qdd, *held = arrays(both, 4)
    forward, back = (jax.vmap(jax.vmap(lambda *x: each(lambda *y: both(*x, *y), (0, 1))(*held)))(q[None], qd[None], qdd[None])
                     for each in (jax.jacfwd, jax.jacrev))
    assert all(near(a, b) for a, b in zip(jax.tree.leaves(forward), jax.tree.leaves(back)))
    assert forward.tau[0].shape == (1, 4, 2, 3)


def case_vmap_of_constants():
    """Over a constant that is one for all samples: it becomes one for each. Values and derivatives, one by one."""
    robot = load("double_pendulum", free=["payload.lower:batch", "gravity"])
    q, qd, qdd, held, _ = arrays(robot, 4)
    loads = held * jnp.linspace(0.5, 2, 4)[:, None]

    def f(q, qd, qdd, p):
        return robot(q, qd, qdd, payload_lower=p)

    def one_by_one(g, *x):
        return jnp.stack([g(*(y[i] for y in x)) for i in range(4)])

    assert near(jax.vmap(f)(q, qd, qdd, loads), one_by_one(f, q, qd, qdd, loads))
    assert near(jax.vmap(lambda p: f(q, qd, qdd, p))(loads), one_by_one(lambda p: f(q, qd, qdd, p), loads))
    assert near(jax.vmap(jax.vmap(f, (0, 0, 0, None)), (None, None, None, 0))(q, qd, qdd, loads),
                one_by_one(lambda p: f(q, qd, qdd, p), loads))
    for g in (jax.grad(lambda *x: f(*x).sum(), 3), jax.jacfwd(f, 3), jax.jacrev(f, 3), jax.jacfwd(f)):
        assert near(jax.vmap(g)(q, qd, qdd, loads), one_by_one(g, q, qd, qdd, loads))


def case_no_jit():
    """Where JAX runs all else step by step, values and derivatives are the same."""
    robot = load("double_pendulum")
    q, qd, qdd = arrays(robot, 3)

    def gradient(q):
        return jax.grad(lambda q: robot(q, qd, qdd).sum())(q)

    right = robot(q, qd, qdd), gradient(q), jax.vmap(robot)(q, qd, qdd)
    with jax.disable_jit():
        assert all(near(a, b) for a, b in zip((robot(q, qd, qdd), gradient(q), jax.vmap(robot)(q, qd, qdd)), right))


def case_second():
    """Hessians beside differences of gradients; floating bases, whose twists do not commute; a Hessian times vectors in one
    call."""
    for name, options in (("double_pendulum", {"want": ["qdd", "kinetic"]}), ("iiwa14", {"want": ["tau", "pose.iiwa_link_7"]}),
                          ("cartpole", {"base": "floating"})):
        robot = load(name, **options)
        q, *rest = (x[0] for x in arrays(robot, 1))

        def loss(q):
            if robot.nq > robot.nv:
                q = jnp.concatenate([q[:3], q[3:7] / jnp.linalg.norm(q[3:7]), q[7:]])
            return sum((x ** 2).sum() for x in jax.tree.leaves(robot(q, *rest)))

        gradient, step = jax.jit(jax.grad(loss)), 1e-6
        right = jnp.stack([(gradient(q + step * e) - gradient(q - step * e)) / (2 * step) for e in np.eye(robot.nq)], 1)
        along = jax.jit(jax.vmap(lambda v: jax.jvp(gradient, (q,), (v,))[1]))(jnp.eye(robot.nq))
        by_jit = [jax.jit(f)(q) for f in (jax.hessian(loss), jax.jacrev(gradient), jax.jacrev(jax.jacfwd(loss)))]
        for hessian in (*by_jit, along.T):
            assert near(hessian, right, 1e-6), options
    robot = load("double_pendulum", free=["mass.lower"])
    slopes, x = jax.grad(lambda *x: (robot(*x) ** 2).sum()), arrays(robot)
    near_by = [slopes(*x[:3], x[3] + s) for s in (step, -step)]
    mixed = (near_by[0] - near_by[1]) / (2 * step)
    assert near(jax.jacfwd(slopes, argnums=3)(*x)[..., 0], mixed, 1e-7)
    along_mass = jax.grad(lambda q: jax.jvp(lambda m: (robot(q, *x[1:3], m) ** 2).sum(), (x[3],), (0 * x[3] + 1,))[1])
    assert near(along_mass(x[0]), mixed, 1e-7)


def case_positions():
    """integrate and difference under jit and derivatives, also where nothing moves."""
    robot = load("cartpole", base="floating")
    q, v = (x[0] for x in arrays(robot, 1)[:2])
    q, v = unit(robot, q), 2 * v / jnp.linalg.norm(v)
    there = jax.jit(robot.integrate)(q, v)
    assert near(there, jnp.asarray(robot.integrate(np.asarray(q), np.asarray(v)))) and near(robot.difference(q, there), v)
    still = jax.jit(jax.jacfwd(lambda v: robot.difference(q, robot.integrate(q, v))))(0 * v)
    assert near(still, jnp.eye(robot.nv)), still
    start = robot.neutral()  # of NumPy, beside a tracer
    assert near(jax.jit(jax.grad(lambda v: robot.integrate(start, v)[0]))(0 * v), jnp.eye(robot.nv)[0])
    round_ = start.copy()
    round_[3:7] = 1, 0, 0, 0
    slope = jax.jit(jax.jacfwd(lambda q: robot.difference(q, round_)))(jnp.asarray(start))
    assert jnp.isfinite(slope).all(), slope
    for kind in ("int32", "float32"):
        made = robot.integrate(jnp.asarray(start, kind), v)
        assert made.dtype == jnp.float64 and near(made, robot.integrate(jnp.asarray(start), v)), kind
    refused(TypeError, ["v", "bfloat16", "float32"], robot.integrate, q, v.astype("bfloat16"))


def case_mujoco():
    """MuJoCo's convention: NumPy's values, and derivatives by MuJoCo's coordinates."""
    robot = load("cartpole", base="floating", convention="mujoco")
    x, plain = arrays(robot, 4), robot.random(4, seed=SEED)
    assert near(jax.jit(robot)(*x), robot(*plain)) and near(jax.vmap(robot)(*x), robot(*plain))
    assert near(robot(plain.q, *x[1:]), robot(*plain))
    for want in ("tau", "M"):
        other = robot.want(want)
        names = [a.name for a in other.inputs]
        given = [dict(zip(("q", "qd", "qdd"), x))[name] for name in names]
        for order, modes in ((1, ["fwd", "rev"]), *([(2, ["rev"])] if want == "tau" else [])):
            check_grads(jax.jit(lambda q, *rest: other(unit(robot, q), *rest)), given, order, modes, rtol=1e-4, atol=1e-3)
    moved = jax.jit(lambda q, v: robot.difference(q, robot.integrate(q, v)))(x[0], x[1] / 9)
    assert near(moved, plain.qd / 9)
    refused(TypeError, ["qd", "float32", "float64"], robot, x[0], x[1].astype("float32"), x[2])
    refused(TypeError, ["bind", "jax.jit"], robot.bind, *x)


def case_transforms():
    """scan, checkpoint, linearize, linear_transpose and a gradient of a gradient's user; what has no second derivatives says
    so."""
    robot = load("double_pendulum", want="qdd")
    q, qd, tau = (x[0] for x in arrays(robot, 1))

    def roll(tau):
        def step(state, _):
            q, qd = state
            qd = qd + 1e-3 * robot(q, qd, tau)
            return (q + 1e-3 * qd, qd), None
        return jax.lax.scan(jax.checkpoint(step), (q, qd), length=5)[0][0].sum()
    check_grads(jax.jit(roll), (tau,), 1, ("fwd", "rev"))
    straight = jax.linearize(lambda q: robot(q, qd, tau), q)[1]
    back, = jax.linear_transpose(straight, q)(qd)
    assert near(back, jax.vjp(lambda q: robot(q, qd, tau), q)[1](qd)[0])
    refused(NotImplementedError, ["second", "double_pendulum", "grad", "hessian", "differences"],
            jax.jacfwd(jax.jacfwd(lambda q: robot(q, qd, tau))), q)
    for third in (jax.jacfwd(jax.hessian(lambda q: robot(q, qd, tau).sum())), jax.grad(lambda q: jax.grad(lambda q: jax.grad(
            lambda q: robot(q, qd, tau).sum())(q).sum())(q).sum())):
        refused(NotImplementedError, ["no third derivatives", "double_pendulum", "hessian", "differences"], third, q)
    bound = robot.want("qdd", "qdd_bound")
    refused(NotImplementedError, ["qdd_bound", "no gradient"], jax.grad(lambda q: bound(q, qd, tau).qdd_bound.sum()), q)
    used = jax.grad(lambda q: bound(q, qd, tau).qdd.sum())(q)  # what is not differentiated does not matter
    assert near(used, jax.grad(lambda q: robot(q, qd, tau).sum())(q))


def case_caching():
    """XLA compiles once for each shape, and not again for a robot of the same URDF and keywords."""
    robot = load("cartpole", gravity=(0, 1, -9))
    x = arrays(robot, 3)
    function = jax.jit(lambda *x: robot(*x).sum())
    right, value = robot(*x), function(*x)
    before, kept = len(compiled), function._cache_size()
    again = pickle.loads(pickle.dumps(robot))
    found = [(robot(*x), again(*x), function(*x)) for _ in range(3)]
    assert len(compiled) == before > 0 and function._cache_size() == kept
    assert all(jnp.array_equal(a, right) and jnp.array_equal(b, right) and c == value for a, b, c in found)
    assert rneagen.jax._jax_operator.operator_of(again) is rneagen.jax._jax_operator.operator_of(robot)
    function(*(y[:2] for y in x))
    assert function._cache_size() == kept + 1
    other = load("cartpole", gravity=(1, 1, -9))
    assert not near(other(*x), robot(*x), 1e-3)


def case_shard_map():
    """Each device computes its own samples; gradients by what is one for all are summed. A bare call gathers, and is right."""
    if len(jax.devices()) < 2:
        print("skipped: shard_map over two devices: JAX sees one")
        return
    robot = load("double_pendulum", free=["payload.lower:batch"])
    mesh = jax.sharding.Mesh(jax.devices()[:2], ("samples",))
    each, whole = PartitionSpec("samples"), PartitionSpec()
    q, qd, qdd, held = arrays(robot, 6)
    tau = robot(q, qd, qdd, held)
    here = [jax.device_put(x, NamedSharding(mesh, each)) for x in (q, qd, qdd)]
    divided = jax.jit(shard_map(robot, mesh=mesh, in_specs=(each, each, each, whole), out_specs=each))
    found = divided(*here, held)
    assert near(jnp.asarray(np.asarray(found)), tau) and found.sharding.is_equivalent_to(NamedSharding(mesh, each), 2)
    assert "all-gather" not in divided.lower(*here, held).compile().as_text()

    def loss(held, q, qd, qdd):
        part = shard_map(lambda held, *x: jax.lax.psum((robot(*x, held) ** 2).sum(), "samples"), mesh=mesh,
                         in_specs=(whole, each, each, each), out_specs=whole)
        return part(held, q, qd, qdd)
    right = jax.grad(lambda held: (robot(q, qd, qdd, held) ** 2).sum())(held)
    for gradient in (jax.grad(loss), jax.jit(jax.grad(loss))):
        assert near(jnp.asarray(np.asarray(gradient(held, *here))), right)
    bare = jax.jit(lambda *x: robot(*x))
    assert near(jnp.asarray(np.asarray(bare(*here, held))), tau) and "all-gather" in bare.lower(*here, held).compile().as_text()


def case_explicit_mesh():
    """Where types tell how arrays are divided: values, and derivatives both ways, some of whose arrays are divided."""
    if len(jax.devices()) < 2 or not hasattr(jax, "set_mesh"):
        print("skipped: a mesh of explicit axes: JAX has none, or sees one device")
        return
    robot = load("double_pendulum", free=["payload.lower:batch"])
    mesh = jax.make_mesh((2,), ("samples",), axis_types=(jax.sharding.AxisType.Explicit,), devices=jax.devices()[:2])
    x = arrays(robot, 6)

    def all_of(*x):
        loss = jax.grad(lambda *x: (robot(*x) ** 2).sum(), (0, 1, 2, 3))
        return robot(*x), loss(*x), jax.jvp(lambda q: robot(q, *x[1:]), x[:1], x[:1])

    right = jax.tree.leaves(all_of(*x))
    other = load("cartpole", base="floating", convention="mujoco")
    y = arrays(other, 6)
    with jax.set_mesh(mesh):
        here = [jax.device_put(a, NamedSharding(mesh, PartitionSpec("samples"))) for a in y]
        assert near(jnp.asarray(np.asarray(other(*here))), np.asarray(other(*y)))
        for divided in ((0, 1, 2), (1,)):
            here = [jax.device_put(y, NamedSharding(mesh, PartitionSpec("samples" if i in divided else None)))
                    for i, y in enumerate(x)]
            for found in (all_of(*here), jax.jit(all_of)(*here)):
                assert all(near(jnp.asarray(np.asarray(a)), b) for a, b in zip(jax.tree.leaves(found), right)), divided


def case_threads():
    robot, found = load("cartpole"), []
    x = arrays(robot, 300)
    right, part = robot(*x), jax.jit(lambda k, *x: robot(*(jax.lax.dynamic_slice_in_dim(y, k, 100) for y in x)))

    def work():
        found.append(all(near(part(k, *x), right[k:k + 100]) for k in range(200)))

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [True] * 4


def case_refusals():
    robot = load("iiwa14")
    q, qd, qdd = arrays(robot, 6)
    refused(TypeError, ["qd", "float32", "q is", "float64"], robot, q, qd.astype("float32"), qdd)
    refused(TypeError, ["q", "int64", "float32"], jax.jit(robot), q.astype(int), qd, qdd)
    refused(TypeError, ["q", "bfloat16"], robot, *(x.astype("bfloat16") for x in (q, qd, qdd)))
    refused(ValueError, ["qd", "(6, 6)"], jax.jit(robot), q, qd[:, :6], qdd)
    refused(ValueError, ["qd", "(5, 7)", "(6, 7)", "q"], robot, q, qd[:5], qdd)
    refused(ValueError, ["qd", "(7,)", "(6, 7)"], robot, q, qd[0], qdd)
    refused(TypeError, ["qdd", "missing"], robot, q, qd)
    refused(TypeError, ["qddd", "qdd"], robot, q, qd, qddd=qdd)
    refused(TypeError, ["out", "written"], robot, q, qd, qdd, out=qdd)
    refused(TypeError, ["bind", "jax.jit"], robot.bind, q, qd, qdd)
    refused(TypeError, ["sparse"], robot.want("M", sparse=True), q)
    refused(TypeError, ["float64", "float32"], load("iiwa14", precision="f32"), q, qd, qdd)
    jax.config.update("jax_enable_x64", False)
    try:
        plain = [np.asarray(x) for x in (q, qd, qdd)]
        assert robot(*plain).dtype == "float64" and robot(jnp.asarray(plain[0]), *plain[1:]).dtype == "float32"
        refused(TypeError, ["f64", "jax_enable_x64"], load("iiwa14", precision="f64"), *(jnp.zeros((2, 7)) for _ in range(3)))
    finally:
        jax.config.update("jax_enable_x64", True)


def case_programs():
    """XLA's program of a robot that is not here, or of other arrays, is refused: nothing runs."""
    def foreign(number, rows):
        call = jax.ffi.ffi_call("rneagen", jax.ShapeDtypeStruct((rows,), "float64"))
        return jax.block_until_ready(jax.jit(lambda *x: call(*x, robot=np.int64(number)))(*[jnp.zeros(7)] * 3))
    refused(Exception, ["robot", "not called with JAX", "load"], foreign, 1, 7)
    robot = load("iiwa14")
    robot(*arrays(robot, 2))
    number = rneagen.jax._jax_operator.operator_of(robot).keep("cpu" if jax.default_backend() == "cpu" else "cuda", "f64")
    assert foreign(number, 7).shape == (7,)
    refused(Exception, ["arrays", "robot"], foreign, number, 6)


def case_unfit():
    """A build without XLA's header says so when it is called, and help() works; a JAX that is too old says so."""
    operator, robot = rneagen.jax._jax_operator, load("iiwa14", want="gravity")
    core, operator._core = operator._core, SimpleNamespace(xla_handlers=lambda: {})
    try:
        assert "jax.grad" in pydoc.render_doc(importlib.reload(rneagen.jax))
        refused(rneagen.BackendError, ["JAX", "jaxlib", "build"], robot, *arrays(robot, 2))
    finally:
        operator._core = core
    version, jax.__version_info__ = jax.__version_info__, (0, 4, 38)
    try:
        refused(rneagen.BackendError, ["too old", "0.6"], importlib.reload, rneagen.jax)
    finally:
        jax.__version_info__ = version
        importlib.reload(rneagen.jax)


def named():
    return {f"test_{name[5:]}": case for name, case in globals().items() if name.startswith("case_")}
