"""What is tested of PyTorch's tensors on the processor and on a GPU alike. `device` is set by the test."""
import os
import tempfile
import warnings

os.environ.setdefault("TORCHINDUCTOR_CACHE_DIR", os.path.join(tempfile.gettempdir(), f"rneagen_inductor_{os.getuid()}"))

from support import SEED, error_of, exhaustive, need, package, refused, robot_file

rneagen, np = package()
torch, = need("torch")
import rneagen.torch
from torch.autograd import gradcheck

LIMITS = {"float32": 2e-4, "float64": 1e-11}
device = "cpu"
backend = "aot_eager"  # of torch.compile


def load(name, **scene):
    return rneagen.load(robot_file(name), **scene)


def tensors(robot, n=None, dtype="float64"):
    return [torch.from_numpy(np.array(x)).to(device) for x in robot.random(n, seed=SEED, dtype=dtype)]


def leaves(robot, n=2):
    """Inputs that are differentiated: freed constants drawn too, which the scene's own draw leaves at the URDF's."""
    draw = torch.Generator().manual_seed(SEED)
    shapes = [a.shape if a.per_batch else (n, *a.shape) for a in robot.inputs]
    return [torch.randn(shape, dtype=torch.float64, generator=draw).to(device).requires_grad_() for shape in shapes]


def unit(robot, q):
    """q with unit quaternions."""
    for joint in robot.joints:
        if joint["nq"] != joint["nv"]:
            i = joint["iq"] + 3
            q = torch.cat([q[..., :i], q[..., i:i + 4] / q[..., i:i + 4].norm(dim=-1, keepdim=True), q[..., i + 4:]], -1)
    return q


def check_gradient(name, **scene):
    robot = load(name, **scene)
    at = [a.role for a in robot.inputs].index("joint_position")

    def function(*x):
        made = robot(*(unit(robot, y) if i == at else y for i, y in enumerate(x)))
        return tuple(made) if isinstance(made, tuple) else made

    assert gradcheck(function, leaves(robot)), (name, scene)


def near(a, b, limit=1e-10):
    return a.shape == b.shape and bool(((a - b).abs() <= limit * (1 + b.abs().max())).all())


# ---- cases ----


def case_values():
    """Any leading shape, both dtypes; dtype and device come back."""
    for name, base in (("iiwa14", "fixed"), ("mimic_chain", "fixed"), ("cartpole", "floating")):
        robot = load(name, base=base)
        for dtype, limit in LIMITS.items():
            states = robot.random(60, seed=SEED, dtype=dtype)
            right = robot(*states)
            x = tensors(robot, 60, dtype)
            tau = robot(*x)
            assert tau.device == x[0].device and tau.dtype == x[0].dtype and error_of(np, tau.cpu().numpy(), right) < limit
            assert torch.equal(robot(*(y.reshape(3, 20, -1) for y in x)).reshape(tau.shape), tau)
            assert torch.equal(robot(*(y[3] for y in x)), tau[3])
            assert torch.equal(robot(x[0], qdd=x[2], qd=x[1]), tau)
            assert robot(*(y[:0] for y in x)).shape == (0, robot.nv)
            both = robot.want("M", "bias")(*x[:2])
            assert both._fields == ("M", "bias") and error_of(np, both.M.cpu().numpy(), robot.crba(states[0])) < limit
            out = torch.empty_like(tau)
            assert robot(*x, out=out) is out and torch.equal(out, tau)
            step = robot.bind(*x, out)
            x[2].zero_()
            assert step() is out and torch.equal(out, robot(*x)) and not torch.equal(out, tau)


def case_left_out():
    robot = load("iiwa14", free=["gravity", "payload.iiwa_link_7"])
    q, qd, qdd = tensors(load("iiwa14"), 5)
    right, down = load("iiwa14")(q, qd, qdd), torch.tensor([0, 0, -9.81], dtype=torch.float64, device=device)
    assert near(robot(q, qd, qdd), right) and near(robot(q, qd, qdd, gravity=down), right)
    assert near(robot(q, qd, qdd, None, torch.zeros(5, 10, dtype=torch.float64, device=device)), right)
    q.requires_grad_()
    again = q.detach().clone().requires_grad_()
    robot(q, qd, qdd).sum().backward()
    load("iiwa14")(again, qd, qdd).sum().backward()
    assert near(q.grad, again.grad)


def case_gradients():
    """gradcheck in f64: fixed bases, joints that follow, floating bodies, constants that are inputs, wrenches."""
    check_gradient("double_pendulum")
    check_gradient("double_pendulum", want="qdd")
    check_gradient("mimic_chain")
    check_gradient("planar_joint")
    check_gradient("floating_joint")
    check_gradient("cartpole", base="floating")
    check_gradient("root_with_mass", base="floating", want="qdd")
    arm = {"free": ["gravity", "payload.lower", "mass.upper:sample", "inertia.lower", "offset.shoulder"], "fext": ["lower"],
           "damping": True}
    check_gradient("double_pendulum", **arm)
    check_gradient("double_pendulum", want="qdd", **arm)
    own = {"free": ["armature", "damping:sample", "friction.elbow"], "friction": 0.1}
    check_gradient("double_pendulum", **own)
    check_gradient("double_pendulum", want="qdd", base="floating", **own)
    check_gradient("double_pendulum", base="floating", fext=["lower"])
    check_gradient("double_pendulum", want=["M", "bias", "gravity", "tau"], **arm)
    check_gradient("cartpole", want=["M", "bias", "gravity", "tau"], damping=True, friction=0.1)
    check_gradient("double_pendulum", want=["qdd", "M", "bias"], refine="1", dynamics="factor")
    check_gradient("double_pendulum", fext=["lower"], fext_frame="world", want=["tau", "wrench.elbow"])


def case_gradients_of_sets():
    """gradcheck in f64 of poses and of several outputs at once, some of them matrices; the freed constants and wrenches too."""
    arm = {"free": ["gravity", "payload.lower", "mass.upper:sample", "offset.shoulder"], "fext": ["lower"], "damping": True}
    check_gradient("double_pendulum", want=["tau", "pose.lower"], **arm)
    check_gradient("double_pendulum", want=["kinetic", "potential", "power", "twist.lower", "accel.lower"], **arm)
    check_gradient("double_pendulum", want=["qdd", "pose.lower", "kinetic", "accel.lower"], **arm)
    check_gradient("mimic_chain", want=["pose.pinion", "jacobian.pinion", "regressor"])
    check_gradient("planar_joint", want=["com", "momentum", "dtau_dq"])
    check_gradient("cartpole", base="floating", want=["pose.pole", "com", "vcom", "tau"], pose="quaternion")
    check_gradient("root_with_mass", base="floating", want=["qdd", "momentum_matrix", "djacobian.leg"], frame="world-aligned")
    if exhaustive():
        check_gradient("iiwa14", want=["tau", "pose.iiwa_link_7", "jacobian.iiwa_link_7"], free=["payload.iiwa_link_7"])
        check_gradient("hyq", base="floating", want=["qdd", "pose.lf_foot", "com"], fext=["rf_foot"], fext_frame="world")


def case_one_sweep():
    """Gradients of two outputs are made by one text; a loss of one of them takes a text of that alone. What fold= makes constant
    has none."""
    robot = load("iiwa14", want=["tau", "pose.iiwa_link_7"])
    q, qd, qdd = (x.requires_grad_() for x in tensors(robot, 4))
    both = robot(q, qd, qdd)
    (both.tau.square().sum() + both.pose_iiwa_link_7[..., 3].sum()).backward()
    made = rneagen.torch.operator_of(robot).gradients.made
    assert list(made) == [("vjp", ("tau", "pose.iiwa_link_7"), ())] and q.grad is not None and qdd.grad is not None
    once = q.grad.clone()
    q.grad = None
    robot(q, qd, qdd).pose_iiwa_link_7[..., 3].sum().backward()
    rest = q.grad.clone()
    q.grad = None
    load("iiwa14")(q, qd, qdd).square().sum().backward()
    assert near(once, rest + q.grad) and len(made) == 2
    still = load("iiwa14", want=["kinetic", "tau"], fold={"qd": 0})
    q.grad = None
    still(q, qdd).kinetic.sum().backward()
    assert torch.equal(q.grad, torch.zeros_like(q))


def case_no_torque():
    """The derivative of one of several outputs where the torque by which qdd is found is known."""
    wanted = ["accel.lower", "qdd"]
    robots = load("double_pendulum", want=wanted, fold={"tau": 0}), load("double_pendulum", want=wanted)
    q, qd = (x.requires_grad_() for x in tensors(robots[0], 4))
    found, right = (torch.autograd.grad(robot(q, qd, *given).accel_lower.sum(), (q, qd))
                    for robot, given in zip(robots, ([], [torch.zeros_like(q)])))
    assert all(map(near, found, right))
    robot = load("double_pendulum", want="qdd", fold={"tau.elbow": 0})  # one row is not read: no derivative by it
    x = [y.requires_grad_() for y in tensors(robot, 2)]
    assert torch.autograd.gradcheck(robot, x, check_forward_ad=True) and torch.autograd.gradgradcheck(robot, x)
    graph = torch.fx.experimental.proxy_tensor.make_fx(robot)(*(y.detach() for y in x)).graph
    assert sum(node.op == "call_function" for node in graph.nodes) == 1  # nothing is copied for it


def case_products():
    """want(jvp=, vjp=, by=) beside the gradient."""
    robot = load("iiwa14", free=["payload.iiwa_link_7"])
    q, qd, qdd, load_of = leaves(robot, 5)
    both = robot.want("tau", "twist.iiwa_link_5")(q, qd, qdd, load_of)
    w = torch.ones(5, 13, dtype=torch.float64, device=device)
    right = torch.autograd.grad([both.tau, both.twist_iiwa_link_5], [q, qd, qdd, load_of], [w[:, :7], w[:, 7:]])
    sweep = robot.want(vjp=["tau", "twist.iiwa_link_5"], by=["payload.iiwa_link_7"])
    found = sweep(*(x.detach() for x in (q, qd, qdd, load_of)), w)
    assert near(found.vjp, torch.cat(right[:3], -1)) and near(found.vjp_payload_iiwa_link_7, right[3])
    assert sweep is robot.want(vjp=["tau", "twist.iiwa_link_5"], by=["payload.iiwa_link_7"])
    along = robot.want(jvp="pose.iiwa_link_7")
    assert [a.name for a in along.inputs] in (["q", "payload_iiwa_link_7", "jvp_v"], ["q", "jvp_v"])
    refused(NotImplementedError, ["no second derivatives by", "payload.iiwa_link_7"],
            sweep(q, qd, qdd, load_of, w).vjp.sum().backward)
    d = torch.randn(5, 21, dtype=torch.float64, generator=torch.Generator().manual_seed(SEED)).to(device).requires_grad_()
    product = along(*(q if a.name == "q" else d if a.name == "jvp_v" else load_of for a in along.inputs))
    found = torch.autograd.grad(product.sum(), [q, d])
    pose = robot.want("pose.iiwa_link_7")
    slope = torch.autograd.grad(pose(*(q if a.name == "q" else load_of for a in pose.inputs)).sum(), q, create_graph=True)[0]
    assert near(found[0], torch.autograd.grad((slope * d[:, :7].detach()).sum(), q)[0]) and near(found[1][:, :7], slope.detach())
    refused(TypeError, ["vpj", "vjp"], robot.want, vpj=["tau"])
    if exhaustive():
        check_gradient("iiwa14")
        check_gradient("iiwa14", want=["qdd"], free=["payload.iiwa_link_7"])
        check_gradient("hyq", base="floating", free=["payload.lf_foot:batch", "gravity"], fext=["rf_foot"])


def case_quaternion():
    """The gradient by a quaternion has no part along it."""
    robot = load("cartpole", base="floating")
    q, qd, qdd = tensors(robot, 20)
    q.requires_grad_()
    robot(q, qd, qdd).square().sum().backward()
    along = (q.grad[:, 3:7] * q.detach()[:, 3:7]).sum(-1).abs().max()
    assert q.grad[:, 3:7].abs().max() > 1 and along < 1e-12 * q.grad.abs().max(), along


def case_precisions():
    """float32, and the arithmetic that differs from what is in memory."""
    plain = load("iiwa14")
    q, qd, qdd = tensors(plain, 8)
    right, = torch.autograd.grad(plain(q.requires_grad_(), qd, qdd).sum(), q)
    for precision, dtype, limit in (("f32", torch.float32, 1e-4), ("mixed", torch.float32, 1e-5),
                                    ("f32x2", torch.float64, 1e-10)):
        x = [y.detach().to(dtype).requires_grad_() for y in (q, qd, qdd)]
        found, = torch.autograd.grad(load("iiwa14", precision=precision)(*x).sum(), x[0])
        assert found.dtype == dtype and near(found.double(), right, limit), precision


def case_lazy():
    """What needs no gradient makes no text of one; nor does a call before it is differentiated."""
    robot = load("cartpole", gravity=(0, 1, -9))
    q, qd, qdd = tensors(robot, 3)
    robot(q, qd, qdd)
    made = rneagen.torch.operator_of(robot).gradients.made
    tau = robot(q.requires_grad_(), qd, qdd)
    assert tau.requires_grad and not made
    tau.sum().backward()
    assert len(made) == 1 and q.grad is not None and qd.grad is None
    with torch.no_grad():
        assert not robot(q, qd, qdd).requires_grad


def case_transforms():
    """vmap, grad, jacrev; what is refused says so."""
    robot = load("iiwa14", free=["payload.iiwa_link_7:batch"])
    matrices = load("iiwa14", want=["dtau_dq", "dtau_dqd"])
    q, qd, qdd = tensors(robot, 6)[:3]
    tau = robot(q, qd, qdd)
    func, right = torch.func, matrices(q, qd, qdd)
    assert torch.equal(func.vmap(lambda *x: robot(*x))(q, qd, qdd), tau)
    assert torch.equal(func.vmap(lambda *x: robot(*x), in_dims=(1, 0, 0))(q.T.contiguous(), qd, qdd), tau)
    assert torch.equal(func.vmap(lambda x: robot(x, qd[0], qdd[0]))(q)[0], tau[0])
    both = robot.want("M", "bias")
    M, bias = func.vmap(lambda *x: tuple(both(*x)))(q, qd)
    assert torch.equal(M, both(q, qd).M) and torch.equal(bias, both(q, qd).bias)
    assert near(func.jacrev(lambda x: robot(x, qd[0], qdd[0]))(q[0]), right.dtau_dq[0])
    assert near(func.vmap(func.jacrev(lambda *x: robot(*x), argnums=1))(q, qd, qdd), right.dtau_dqd)
    assert near(torch.autograd.functional.jacobian(lambda x: robot(q[0], x, qdd[0]), qd[0]), right.dtau_dqd[0])
    assert near(func.grad(lambda x: robot(x, qd, qdd).sum())(q), right.dtau_dq.sum(-2))
    assert near(func.jacfwd(lambda x: robot(x, qd[0], qdd[0]))(q[0]), right.dtau_dq[0])


def case_transforms_of_constants():
    """vmap over a constant that is one for all samples makes it one for each; gradients by one, of one sample and of many."""
    robot, func = load("double_pendulum", free=["payload.lower:batch", "gravity"]), torch.func
    q, qd, qdd, held, g = tensors(robot, 4)
    loads = held * torch.linspace(0.5, 2, 4, dtype=torch.float64, device=device)[:, None]

    def f(q, qd, qdd, p):
        return robot(q, qd, qdd, payload_lower=p)

    def one_by_one(g, *x):
        return torch.stack([g(*(y[i] for y in x)) for i in range(4)])

    assert near(func.vmap(f)(q, qd, qdd, loads), one_by_one(f, q, qd, qdd, loads))
    assert near(func.vmap(lambda p: f(q, qd, qdd, p))(loads), one_by_one(lambda p: f(q, qd, qdd, p), loads))
    for d in (func.grad(lambda *x: f(*x).sum(), argnums=3), func.jacfwd(f, argnums=3), func.jacrev(f, argnums=3), func.jacfwd(f)):
        assert near(func.vmap(d)(q, qd, qdd, loads), one_by_one(d, q, qd, qdd, loads))
    for wrong in (loads[:, :3], loads[:, None]):  # as without vmap
        refused(ValueError, ["payload_lower", str(tuple(wrong.shape[1:])), "(10,)"], func.vmap(f), q, qd, qdd, wrong)
    right = robot.want("dtau_dgravity")(q, held, g)
    assert near(func.jacfwd(lambda *x: robot(*x), argnums=4)(q, qd, qdd, held, g), right)
    there = g.clone().requires_grad_()
    robot(q[0], qd[0], qdd[0], held, there)[1].backward()
    assert near(there.grad, right[0, 1])


def case_compiled_transforms():
    """Within torch.compile: the derivatives of torch.func and of dual numbers, in one graph, and of a compiled function."""
    robot, func = load("cartpole"), torch.func
    q, qd, qdd = tensors(robot, 3)

    def dual(q):
        with torch.autograd.forward_ad.dual_level():
            y = robot(torch.autograd.forward_ad.make_dual(q, qd), qd, qdd)
            return torch.autograd.forward_ad.unpack_dual(y).tangent

    def f(q):
        return robot(q, qd, qdd)

    for d in (lambda q: func.jvp(f, (q,), (qd,))[1], dual, func.jacfwd(f), func.jacrev(f), func.jacrev(func.jacfwd(f)),
              func.grad(lambda q: f(q).sum()), func.hessian(lambda q: f(q).sum()),
              lambda q: func.vmap(func.grad(lambda *x: robot(*x).sum()))(q, qd, qdd)):
        torch.compiler.reset()
        right = d(q)
        assert right.abs().max() > 0 and near(torch.compile(d, fullgraph=True, backend=backend)(q), right)
    torch.compiler.reset()
    assert near(func.jvp(torch.compile(f, backend=backend), (q,), (qd,))[1], dual(q))


def case_written():
    """Who has kept what out= writes over is told; what nobody would differentiate is refused."""
    robot = load("cartpole")
    q, qd, qdd = tensors(robot, 3)
    w, tau = torch.ones_like(q).requires_grad_(), torch.empty_like(q)
    loss = (w * robot(q, qd, qdd, out=tau)).sum()
    robot(2 * q, qd, qdd, out=tau)
    refused(RuntimeError, ["inplace"], loss.backward)
    refused(ValueError, ["out", "gradient"], robot, q, qd, qdd, out=w * 3)
    refused(TypeError, ["out", "NumPy"], rneagen.load(robot_file("gantry"), want="gravity"), out=torch.zeros(3))
    refused(ValueError, ["out=", "derivatives"], torch.func.jvp, lambda x: robot(x, qd, qdd, out=torch.empty_like(q)),
            (q,), (qd,))
    with torch.autograd.forward_ad.dual_level():
        refused(ValueError, ["bound step", "derivatives"], robot.bind, torch.autograd.forward_ad.make_dual(q, qd), qd, qdd)


def case_bound_memory():
    """A step whose tensor has other memory says so; the memory that it was bound to stays until then."""
    robot = load("cartpole")
    x = tensors(robot, 100000)
    step = robot.bind(*x)
    assert torch.equal(step(), robot(*x))
    kept = x[0].clone()
    x[0].data = kept
    refused(RuntimeError, ["q", "bind"], step)
    step = robot.bind(*x)
    x[0].untyped_storage().resize_(0)
    refused(RuntimeError, ["q", "bind"], step)


def case_many_tangents():
    """Of PyTorch's older vectorised Jacobian."""
    robot = load("cartpole")
    q, qd, qdd = (x[0] for x in tensors(robot, 1))
    found = torch.autograd.functional.jacobian(lambda q: robot(q, qd, qdd), q, vectorize=True, strategy="forward-mode")
    assert near(found, torch.func.jacrev(lambda q: robot(q, qd, qdd))(q))


def case_forward():
    """Tangents beside gradients: w . (J d) is (J' w) . d."""
    draw = torch.Generator().manual_seed(SEED)
    for options in ({}, {"want": ["tau", "M"]}, {"base": "floating"}, {"free": ["gravity", "payload.iiwa_link_7"]},
                    {"want": "qdd"}):
        robot = load("iiwa14", **options)
        x = tensors(robot, 3)
        if robot.nq > robot.nv:
            x[0][:, 3:7] /= x[0][:, 3:7].norm(dim=-1, keepdim=True)
        d = [torch.randn(y.shape, dtype=y.dtype, generator=draw).to(device) for y in x]

        def flat(*arrays):
            made = robot(*arrays)
            return torch.cat([y.reshape(-1) for y in (made if isinstance(made, tuple) else (made,))])

        value, along = torch.func.jvp(flat, tuple(x), tuple(d))
        back = torch.func.vjp(flat, *x)[1](value)
        assert near(value @ along, sum((a * b).sum() for a, b in zip(back, d)), 1e-11), options
        with torch.autograd.forward_ad.dual_level():
            dual = flat(*(torch.autograd.forward_ad.make_dual(a, b) for a, b in zip(x, d)))
            assert torch.equal(torch.autograd.forward_ad.unpack_dual(dual).tangent, along), options


def case_second():
    """Gradients of gradients beside differences of gradients, and Hessians by either way; floating bases, whose twists do not
    commute."""
    for name, options in (("iiwa14", {"want": ["tau", "pose.iiwa_link_7"]}), ("iiwa14", {"want": "qdd"}),
                          ("cartpole", {"base": "floating"})):
        robot = load(name, **options)
        x = [y.requires_grad_() for y in tensors(robot, 2)]
        is_floating = robot.nq > robot.nv

        def outputs(q, *others):
            if is_floating:
                q = torch.cat([q[:, :3], q[:, 3:7] / q[:, 3:7].norm(dim=-1, keepdim=True), q[:, 7:]], -1)
            return robot(q, *others)

        assert torch.autograd.gradgradcheck(outputs, x, atol=1e-5, rtol=1e-4), options
        rest = [y.detach()[:1] for y in x[1:]]

        def loss(q):
            made = outputs(q[None], *rest)
            return sum(y.square().sum() for y in (made if isinstance(made, tuple) else (made,)))

        hessian = torch.func.hessian(loss)(x[0].detach()[0])
        assert near(hessian, hessian.T, 1e-11), options
        assert near(torch.autograd.functional.hessian(loss, x[0].detach()[0]), hessian, 1e-11), options
        bent = torch.func.jacrev(torch.func.jacfwd(loss))(x[0].detach()[0])
        assert near(bent, hessian, 1e-11), options
        refused(NotImplementedError, ["no third derivatives", "hessian", "differences"],
                torch.func.jacfwd(torch.func.hessian(loss)), x[0].detach()[0])
    slides = load("gantry", want="qdd", fold={"qd": 0})  # linear in tau: its vjp does not vary
    Minv, (q, tau) = torch.from_numpy(np.linalg.inv(load("gantry", want="M")())).to(device), tensors(slides)
    for hessian in (torch.func.hessian, lambda f: lambda x: torch.autograd.functional.hessian(f, x)):
        assert near(hessian(lambda x: slides(q, x).square().sum())(tau), 2 * Minv @ Minv)


def case_second_beside_free():
    """Second derivatives by the state where what is free requires gradients too; by it, forward of gradients; others are refused
    once they are asked for."""
    robot = load("double_pendulum", free=["mass.lower", "gravity"])
    x = [y.requires_grad_() for y in tensors(robot, 3)]
    q, mass = x[0], x[3]

    def slope():
        return torch.autograd.grad(robot(*x).square().sum(), q, create_graph=True)[0].sum()

    right = torch.func.hessian(lambda q: robot(q, *x[1:]).square().sum())(q.detach()).sum((0, 1))
    assert near(torch.autograd.grad(slope(), q)[0], right)
    slope().backward(inputs=[q])
    assert near(q.grad, right)
    for by in (slope().backward, lambda: torch.autograd.grad(slope(), mass), lambda: torch.autograd.grad(slope(), [q, mass])):
        refused(NotImplementedError, ["double_pendulum", "no second derivatives by"], by)
    slopes, step = torch.func.grad(lambda *x: robot(*x).square().sum()), 1e-6
    there = [y.detach() for y in x]
    mixed = torch.func.jacfwd(slopes, argnums=3)(*there)[..., 0]
    near_by = [slopes(*there[:3], there[3] + s, there[4]) for s in (step, -step)]
    assert near(mixed, (near_by[0] - near_by[1]) / (2 * step), 1e-7)
    both = robot.want("tau", vjp=["tau"])
    w = torch.ones_like(q)
    assert near(torch.autograd.grad(both(*x, w).tau.sum(), mass)[0], torch.autograd.grad(robot(*x).sum(), mass)[0])


def case_positions():
    """integrate and difference have gradients, also where nothing moves."""
    robot = load("cartpole", base="floating")
    q, v = tensors(robot, 3)[:2]
    q[:, 3:7] /= q[:, 3:7].norm(dim=-1, keepdim=True)
    v = 2 * v / v.norm(dim=-1, keepdim=True)
    v[0] = 0
    there = robot.integrate(q, v)
    assert near(robot.difference(q, there), v)
    assert near(there, torch.from_numpy(robot.integrate(q.cpu().numpy(), v.cpu().numpy())).to(device))
    x = [q.requires_grad_(), v.requires_grad_()]
    assert torch.autograd.gradcheck(robot.integrate, x)
    assert torch.autograd.gradcheck(robot.difference, [q, there.detach().requires_grad_()])
    refused(ValueError, ["v", "(3, 8)"], robot.integrate, q, q)
    q, v = q.detach(), v.detach()
    start = torch.from_numpy(robot.neutral()).to(device)
    right = robot.integrate(start, v[0])
    for kind in (torch.int32, torch.float32):
        made = robot.integrate(start.to(kind), v[0])
        assert made.dtype == torch.float64 and near(made, right) and near(robot.difference(start.to(kind), made), v[0]), kind
    refused(TypeError, ["q", "float16", "float32"], robot.integrate, q.half(), v)
    with torch.autocast(torch.device(device).type, torch.bfloat16):
        assert robot.integrate(q.bfloat16(), v.bfloat16()).dtype == torch.float32
    moved = torch.compile(lambda q, v: robot.difference(q, robot.integrate(q, v)), fullgraph=True, backend=backend)
    assert near(moved(q, v), v) and moved(q.float(), v).dtype == torch.float64


def case_mujoco():
    """MuJoCo's convention: NumPy's values, derivatives by MuJoCo's coordinates, and in one graph."""
    for name, want in (("cartpole", ["tau", "M", "gravity"]), ("shuffled_order", ["qdd"])):
        check_gradient(name, base="floating", convention="mujoco", want=want)
    robot = load("cartpole", base="floating", convention="mujoco")
    x, arrays = tensors(robot, 6), robot.random(6, seed=SEED)
    right = torch.from_numpy(robot(*arrays)).to(device)
    assert near(robot(*x), right) and near(torch.func.vmap(robot)(*x), right)
    out = torch.empty_like(right)
    assert robot(*x, out=out) is out and near(out, right)
    assert near(robot.nonLinearEffects(*x[:2]), torch.from_numpy(robot.nonLinearEffects(*arrays[:2])).to(device))
    compiled = torch.compile(lambda q, v, a: robot(robot.integrate(q, v), v, a), fullgraph=True, backend=backend)
    moved = robot.integrate(arrays.q, arrays.qd)
    assert near(compiled(*x), torch.from_numpy(robot(moved, *arrays[1:])).to(device))
    assert near(robot.difference(x[0], robot.integrate(x[0], x[1] / 9)), x[1] / 9)
    refused(TypeError, ["qd", "float32", "float64"], robot, x[0], x[1].float(), x[2])
    refused(ValueError, ["qd", "(5, 8)", "(6, 8)"], robot, x[0], x[1][:5], x[2])
    refused(TypeError, ["mujoco", "bind"], robot.bind, *x)
    refused(ValueError, ["q", "gradient", "out="], robot, x[0].clone().requires_grad_(), x[1], x[2], out=out)


def case_pieces():
    """Tensors in several pieces are copied: of a state that is split, and where a gradient goes back to it."""
    robot = load("iiwa14")
    q, qd, qdd = tensors(robot, 6)
    state, tau = torch.cat([q, qd, qdd], -1).requires_grad_(), robot(q, qd, qdd)
    assert torch.equal(robot(*state.detach().chunk(3, -1)), tau) and torch.equal(robot(q, qd, qdd.T.contiguous().T), tau)
    assert torch.equal(robot(q, qd[0].expand(6, 7), qdd), robot(q, qd[0].repeat(6, 1), qdd))
    robot(*state.chunk(3, -1)).sum().backward()
    assert near(state.grad[:, :7], robot.want("dtau_dq")(q, qd, qdd).sum(-2))
    compiled = torch.compile(lambda s: robot(*s.chunk(3, -1)) * 1, fullgraph=True, backend=backend)
    assert torch.equal(compiled(state.detach()), tau)
    refused(ValueError, ["qdd", "contiguous"], robot.bind, q, qd, qdd.T.contiguous().T)
    refused(ValueError, ["out", "contiguous"], robot, q, qd, qdd, out=torch.empty(7, 6, dtype=qdd.dtype, device=device).T)


def case_autocast():
    """Halves that a layer leaves are taken as float32."""
    robot, layer = load("iiwa14"), torch.nn.Linear(7, 7).to(device)
    q, qd, qdd = (x.float() for x in tensors(robot, 6))
    with torch.autocast(device, torch.bfloat16):
        made = layer(q)
        tau = robot(made, qd, qdd)
        tau.sum().backward()
    assert made.dtype == torch.bfloat16 and tau.dtype == torch.float32 and torch.equal(tau, robot(made.float(), qd, qdd))
    assert layer.weight.grad.abs().sum() > 0


def case_compile():
    """torch.compile(fullgraph=True): no break, the same values and gradients."""
    robot, floating = load("iiwa14"), load("cartpole", base="floating")

    def compiled(function, **options):
        torch._dynamo.reset()
        return torch.compile(function, fullgraph=True, backend=backend, **options)

    for each in (robot, floating):
        plain, there = tensors(each, 5), tensors(each, 5)
        for x in (*plain, *there):
            x.requires_grad_()
        loss = each(*plain).square().mean()
        loss.backward()
        again = compiled(lambda *x: each(*x).square().mean())(*there)
        again.backward()
        assert near(again, loss) and all(near(a.grad, b.grad) for a, b in zip(there, plain))
    q, qd, qdd = tensors(robot, 5)
    tau, both = robot(q, qd, qdd), robot.want("M", "bias")
    bent = compiled(lambda *x: robot(*x) + 0, dynamic=True)
    assert torch.equal(bent(q, qd, qdd), tau) and torch.equal(bent(q[:3], qd[:3], qdd[:3]), tau[:3])
    assert torch.equal(compiled(lambda a, b: both(a, b).M * 1)(q, qd), both(q, qd).M)
    assert torch.equal(compiled(lambda: robot(q, qdd=qdd, qd=qd))(), tau)
    out = torch.zeros_like(tau)
    assert torch.equal(compiled(lambda: robot(q, qd, qdd, out=out) * 1)(), tau) and torch.equal(out, tau)
    fresh = load("cartpole", gravity=(1, 0, 0))
    assert compiled(lambda *x: fresh(*x))(*tensors(fresh, 2)).shape == (2, 2)
    assert near(compiled(lambda a, b: fresh.want("M", "gravity")(a).M @ b)(*tensors(fresh)[:2]),
                fresh.crba(tensors(fresh)[0]) @ tensors(fresh)[1])
    args = [x.requires_grad_() for x in (q, qd, qdd)]
    told = torch.library.opcheck(rneagen.torch.operator_of(robot).op, args)
    assert set(told.values()) == {"SUCCESS"}, told


def case_fake():
    """Where PyTorch only looks at shapes, nothing is computed."""
    from torch._subclasses.fake_tensor import FakeTensorMode
    robot = load("cartpole")
    with FakeTensorMode() as mode:
        x = [mode.from_tensor(y) for y in tensors(robot, 4)]
        tau = robot(*x)
    assert type(tau) is type(x[0]) and tau.shape == (4, 2)
    assert robot(*(y.to("meta") for y in tensors(robot, 4))).shape == (4, 2)


def case_odd_tensors():
    """Tensors that are not plain memory, and a robot whose name begins with a digit."""
    with open(robot_file("pendulum")) as file:
        urdf = file.read()
    digit = rneagen.load(urdf.replace('name="pendulum"', 'name="2 links"').encode())
    q, qd, qdd = tensors(digit, 4)
    assert digit.name == "2 links" and near(digit(q, qd, qdd), load("pendulum")(q, qd, qdd))
    negated = torch.complex(torch.zeros_like(q), -q).conj().imag
    assert negated.is_neg() and torch.equal(digit(negated, qd, qdd), digit(q, qd, qdd))
    robot = load("iiwa14")
    q, qd, qdd = tensors(robot, 2)
    refused(ValueError, ["qd", "meta", "q on"], robot, q, qd.to("meta"), qdd)
    freed = qd.clone()
    freed.untyped_storage().resize_(0)
    refused((ValueError, RuntimeError), ["qd"] if device == "cpu" else [], robot, q, freed, qdd)


def case_many_gradients():
    """Gradients for several vectors at once, and a Jacobian by them."""
    robot = load("iiwa14")
    q, qd, qdd = tensors(robot, 2)
    q.requires_grad_()
    w = torch.randn(3, 2, 7, dtype=torch.float64, generator=torch.Generator().manual_seed(SEED)).to(device)
    tau = robot(q, qd, qdd)
    right = torch.stack([torch.autograd.grad(tau, q, x, retain_graph=True)[0] for x in w])
    assert near(torch.autograd.grad(tau, q, w, is_grads_batched=True)[0], right)
    J = torch.autograd.functional.jacobian(lambda x: robot(x, qd, qdd), q.detach(), vectorize=True)
    assert near(J[0, :, 0], robot.want("dtau_dq")(q.detach(), qd, qdd)[0]) and not J[0, :, 1].any()


def case_pinocchio_names():
    """With all that Pinocchio's functions take, where the robot reads less; constants come on the same device."""
    robot = load("pendulum")
    q, qd, qdd = tensors(robot, 4)
    assert torch.equal(robot.rnea(q, qd, qdd), robot(q, qd, qdd))
    M = robot.crba(q.float())
    assert M.shape == (4, 1, 1) and M.dtype == torch.float32 and M.device == q.device
    compiled = torch.compile(lambda *x: robot.rnea(*x) * 1, fullgraph=True, backend=backend)
    assert torch.equal(compiled(q, qd, qdd), robot(q, qd, qdd))


def case_refusals():
    robot = load("iiwa14")
    q, qd, qdd = tensors(robot, 6)
    refused(TypeError, ["qd", "float32", "q is", "float64"], robot, q, qd.float(), qdd)
    refused(TypeError, ["q", "int64", "float32"], robot, q.long(), qd, qdd)
    refused(TypeError, ["q", "float16"], robot, q.half(), qd.half(), qdd.half())
    refused(ValueError, ["qd", "(6, 6)"], robot, q, qd[:, :6].contiguous(), qdd)
    refused(ValueError, ["qd", "(5, 7)", "(6, 7)", "q"], robot, q, qd[:5], qdd)
    refused(TypeError, ["qd", "NumPy", "PyTorch"], robot, q, qd.cpu().numpy(), qdd)
    refused(TypeError, ["qd", "PyTorch", "NumPy"], robot, q.cpu().numpy(), qd, qdd)
    refused(TypeError, ["qdd", "missing"], robot, q, qd)
    for call in (robot, load("iiwa14", free=["gravity"]), robot.rnea, robot.bind):
        refused(TypeError, ["qd is missing", "q, qd, qdd"], call, q, None, qdd)
        refused(TypeError, ["qdd is missing"], call, q.clone().requires_grad_(), qd, None)
    refused(TypeError, ["qd is missing"], torch.func.vmap(lambda x: robot(x, None, qdd[0])), q)
    refused(TypeError, ["qddd", "qdd"], robot, q, qd, qddd=qdd)
    refused(ValueError, ["out", "tau", "(6, 6)"], robot, q, qd, qdd, out=q[:, :6].contiguous())
    refused(ValueError, ["out", "overlaps", "qdd"], robot, q, qd, qdd, out=qdd)
    refused(TypeError, ["out", "NumPy"], robot, q, qd, qdd, out=qdd.cpu().numpy())
    refused(TypeError, ["out", "tuple", "2"], robot.want("M", "bias"), q, qd, out=qdd)
    refused(ValueError, ["q", "gradient", "out="], robot, q.clone().requires_grad_(), qd, qdd, out=torch.empty_like(q))
    refused(ValueError, ["q", "gradient", "bound"], robot.bind, q.clone().requires_grad_(), qd, qdd)
    refused(TypeError, ["sparse"], robot.want("M", sparse=True), q)
    bounded = load("iiwa14", want="qdd_bound")
    refused(NotImplementedError, ["qdd_bound", "no gradient", "bound"],
            bounded(q.clone().requires_grad_(), qd, qdd).sum().backward)
    refused(TypeError, ["float64", "float32"], load("iiwa14", precision="f32"), q, qd, qdd)


def case_dense():
    """What PyTorch stores in other ways names the argument, in the plain call and in those with gradients."""
    robot = load("iiwa14")
    q, qd, qdd = tensors(robot, 2)
    with warnings.catch_warnings(action="ignore"):  # PyTorch calls them a beta
        nested = [torch.nested.nested_tensor([qd[0], qd[1]], layout=layout) for layout in (torch.strided, torch.jagged)]
        sparse = [qd.to_sparse(), qd.to_sparse_csr()]
    for x in (*sparse, *nested):
        words = ["nested" if x.is_nested else "sparse", "nested" if x.is_nested else "to_dense()"]
        for call in (robot, robot.bind, robot.want("tau", "M")):
            refused(TypeError, ["qd: ", *words], call, q, x, qdd)
            refused(TypeError, ["q: ", *words], call, x, qd, qdd)
        refused(TypeError, ["qd: ", *words], robot, q.clone().requires_grad_(), x, qdd)
        refused(TypeError, ["out: ", *words], robot, q, qd, qdd, out=x)


def named():
    return {f"test_{name[5:]}": case for name, case in globals().items() if name.startswith("case_")}
