# Grains that settle in a container and flow once it opens, in YADE. Reads parameters.json and packing.txt from the working
# folder, writes grains.dump and progress.txt there. Copied into each run's folder; to rerun by hand:
# yade -n -x -j1 gravity_flow.py
import json
import math

from yade import *  # YADE runs this with its names loaded; the import is for readers and tools

with open('parameters.json') as file:
    parameters = json.load(file)

lower, upper = parameters['lower_m'], parameters['upper_m']
size = [upper[k] - lower[k] for k in range(3)]
diameter = parameters['diameter_m']
fixed_count = parameters['fixed_count']
verlet_distance = 0.15 * diameter
periodic = parameters['periodic']

# Bodies of equal mask that share a bit with avoidSelfInteractionMask do not touch each other: fixed grains and walls.
MOBILE_MASK, FIXED_MASK, AVOIDED_BIT = 1, 3, 2


def add_materials():
    elastic = dict(young=parameters['youngs_modulus_pa'], poisson=parameters['poissons_ratio'], density=parameters['density_kg_m3'])
    O.materials.append(FrictMat(label='grain', frictionAngle=math.atan(parameters['friction']), **elastic))
    O.materials.append(FrictMat(label='wall', frictionAngle=math.atan(parameters['wall_friction']), **elastic))


def add_grains():
    with open('packing.txt') as file:
        rows = [[float(word) for word in line.split()] for line in file if not line.startswith('#')]
    for index, (x, y, z, vx, vy, vz, radius) in enumerate(rows):
        fixed = index < fixed_count
        body = utils.sphere((x, y, z), radius, material='grain', fixed=fixed, mask=FIXED_MASK if fixed else MOBILE_MASK)
        body.state.vel = (vx, vy, vz)
        assert O.bodies.append(body) == index


# A Box, as a Wall hangs in a periodic cell; and one far larger than the cell, so that its edges are out of reach. Its faces
# must stand just inside a cell's ends: the collider's first pass wraps them into the cell and tests a box only against
# the grains between its wrapped faces, so that from a box of a whole number of cells all grains near it at the start leak.
def add_plane(axis, face, towards, material):
    if periodic:
        half = [1000.5 * O.cell.size[k] - 2 * verlet_distance for k in range(3)]
        centre = [0.5 * O.cell.size[k] for k in range(3)]
    else:
        half = [2 * size[k] for k in range(3)]
        centre = [0.5 * (lower[k] + upper[k]) for k in range(3)]
    half[axis] = diameter
    centre[axis] = face - towards * half[axis]
    return O.bodies.append(utils.box(centre, half, material=material, fixed=True, mask=FIXED_MASK))


def add_shell(triangles, material):
    facets = [utils.facet(corners, material=material, fixed=True, mask=FIXED_MASK) for corners in triangles]
    return [O.bodies.append(facet) for facet in facets]


def write_heading(file, step, items, count):
    bounds = 'ff pp ff' if periodic else 'ff ff ff'
    file.write('ITEM: TIMESTEP\n%d\nITEM: NUMBER OF %s\n%d\nITEM: BOX BOUNDS %s\n' % (step, items, count, bounds))
    for k in range(3):
        file.write('%.10g %.10g\n' % (lower[k], upper[k]))


# Contacts of spheres with each other: places of the two centres, their ids, force on the first.
def write_contacts(file, step):
    contacts = [(O.bodies[i.id1], O.bodies[i.id2], -(i.phys.normalForce + i.phys.shearForce)) for i in O.interactions if i.isReal]
    contacts = [contact for contact in contacts if isinstance(contact[0].shape, Sphere) and isinstance(contact[1].shape, Sphere)]
    write_heading(file, step, 'ENTRIES', len(contacts))
    file.write('ITEM: ENTRIES x1 y1 z1 x2 y2 z2 id1 id2 fx fy fz\n')
    for first, second, force in contacts:
        ids = (first.id + 1, second.id + 1)
        file.write('%.10g %.10g %.10g %.10g %.10g %.10g %d %d %.10g %.10g %.10g\n' % (*first.state.pos, *second.state.pos, *ids, *force))
    file.flush()


def write_snapshot(file, step):
    write_heading(file, step, 'ATOMS', len(mobile))
    file.write('ITEM: ATOMS id x y z vx vy vz\n')
    for body in mobile:
        file.write('%d %.10g %.10g %.10g %.10g %.10g %.10g\n' % (body.id + 1, *body.state.pos, *body.state.vel))
    file.flush()


def run(steps, stage):
    O.run(steps, True)
    progress.write('%s %d\n' % (stage, O.iter))
    progress.flush()


if periodic:
    O.periodic = True
    # Only y is meant to be periodic: the cell is so long and high that nothing meets its image along x or z.
    O.cell.setBox(size[0] + 20 * diameter, size[1], 2 * size[2] + 20 * diameter)
add_materials()
add_grains()
planes = [(plane, add_plane(plane['axis'], plane['at_m'], plane['inward'], plane['material'])) for plane in parameters['planes']]
shells = [(shell, add_shell(shell['triangles_m'], shell['material'])) for shell in parameters['shells']]
mobile = [body for body in O.bodies if isinstance(body.shape, Sphere) and body.id >= fixed_count]


O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Box_Aabb(), Bo1_Facet_Aabb()],
                          allowBiggerThanPeriod=True, avoidSelfInteractionMask=AVOIDED_BIT, verletDist=verlet_distance),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Box_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom()],
                    [Ip2_FrictMat_FrictMat_MindlinPhys(en=parameters['restitution'],
                                                       krot=parameters['rolling_stiffness_n_m'],
                                                       eta=parameters['rolling_resistance'])],
                    [Law2_ScGeom_MindlinPhys_Mindlin(includeMoment=True)]),
    NewtonIntegrator(damping=0, gravity=(0, 0, -parameters['gravity_m_s2'])),
]
O.dt = parameters['time_step_s']

per_snapshot = parameters['steps_per_snapshot']
progress = open('progress.txt', 'w')
full, rest = divmod(parameters['settle_steps'], per_snapshot)
for _ in range(full):
    run(per_snapshot, 'settling')
if rest:
    O.run(rest, True)

O.bodies.enableRedirection = False  # bodies keep their ids
for plane, body in planes:
    if plane['until_release']:
        O.bodies.erase(body)
for shell, facets in shells:
    for facet in facets:
        if shell['until_release']:
            O.bodies.erase(facet)
        else:
            O.bodies[facet].state.vel = (0, 0, shell['rise_speed_m_s'])
with open('grains.dump', 'w') as dump, open('contacts.dump', 'w') as contacts:
    write_snapshot(dump, 0)
    write_contacts(contacts, 0)
    for count in range(1, parameters['snapshot_count'] + 1):
        run(per_snapshot, 'running')
        write_snapshot(dump, count * per_snapshot)
    write_contacts(contacts, parameters['snapshot_count'] * per_snapshot)
