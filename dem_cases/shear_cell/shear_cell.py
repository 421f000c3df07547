# The shear cell in YADE: plane-strain biaxial compression in a periodic cell. Reads parameters.json and packing.txt from
# the working folder, writes samples.txt there. Copied into each run's folder; to rerun by hand:  yade -n -x -j1 shear_cell.py
import json
import math

from yade import *  # YADE runs this with its names loaded; the import is for readers and tools

with open('parameters.json') as file:
    parameters = json.load(file)

wanted = parameters['lateral_stress_pa']
gain = parameters['servo_gain_per_s']
closing = parameters['closing_rate_per_s']
axial_rate = parameters['axial_rate_per_s']
per_sample = parameters['steps_per_sample']


def add_grains():
    O.materials.append(FrictMat(frictionAngle=math.atan(parameters['friction']), young=parameters['youngs_modulus_pa'],
                                poisson=parameters['poissons_ratio'], density=parameters['density_kg_m3']))
    with open('packing.txt') as file:
        rows = [[float(word) for word in line.split()] for line in file if not line.startswith('#')]
    for x, y, z, vx, vy, vz, radius in rows:
        body = utils.sphere((x, y, z), radius)
        body.state.vel = (vx, vy, vz)
        O.bodies.append(body)
    return sum(4.0 / 3.0 * math.pi * row[6]**3 for row in rows)


def stresses():
    stress = utils.getStress()  # positive in tension
    return [-stress[axis, axis] for axis in range(3)]


def set_rates(rates):
    O.cell.velGrad = Matrix3(rates[0], 0, 0, 0, rates[1], 0, 0, 0, rates[2])


def servo(stress):
    return gain * (stress / wanted - 1.0)


# The same law as in the LIGGGHTS deck: PeriTriaxController misses its stress.
def set_compression_rates():
    set_rates([servo(s) - (closing if s < parameters['resisting_share'] * wanted else 0.0) for s in stresses()])


def set_shear_rates():
    set_rates([axial_rate + servo(stresses()[0]), 0.0, -axial_rate])


O.periodic = True
O.cell.setBox(*parameters['size_m'])
solid_volume = add_grains()
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb()], allowBiggerThanPeriod=True, verletDist=0.15 * parameters['diameter_m']),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom()],
                    [Ip2_FrictMat_FrictMat_MindlinPhys(en=parameters['restitution'],
                                                       krot=parameters['rolling_stiffness_n_m'],
                                                       eta=parameters['rolling_resistance'])],
                    [Law2_ScGeom_MindlinPhys_Mindlin(includeMoment=True)]),
    NewtonIntegrator(damping=0),
    PyRunner(command='set_compression_rates()', iterPeriod=per_sample, label='servo_runner'),
]
O.dt = parameters['time_step_s']
O.run(parameters['compression_steps'], True)

servo_runner.command = 'set_shear_rates()'
set_shear_rates()
start_length = O.cell.size[2]
with open('samples.txt', 'w') as samples:
    samples.write(parameters['columns'] + '\n')
    for count in range(1, parameters['shear_steps'] // per_sample + 1):
        O.run(per_sample, True)
        lengths = O.cell.size
        samples.write('%d %.10g %.10g %.10g %.10g %.10g %.10g %d\n' % (
            count * per_sample, *stresses(), solid_volume / (lengths[0] * lengths[1] * lengths[2]),
            math.log(start_length / lengths[2]), utils.kineticEnergy(), len(O.bodies)))
        if count % 100 == 0:
            samples.flush()
