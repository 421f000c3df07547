# The sphere of an impact. The harness puts this into gravity_flow.py, where the release is: it adds the ball to the settled bed
# and has every snapshot followed by a row of the ball's track, bodies.csv (analysis/body_track.h).
sphere = parameters['sphere']
O.materials.append(FrictMat(label='ball', young=parameters['youngs_modulus_pa'], poisson=parameters['poissons_ratio'],
                            density=sphere['density_kg_m3'], frictionAngle=math.atan(parameters['friction'])))
ball = O.bodies[O.bodies.append(utils.sphere(sphere['centre_m'], sphere['radius_m'], material='ball', mask=MOBILE_MASK))]
ball.state.vel = (0, 0, -sphere['speed_m_s'])
track = open('bodies.csv', 'w')
track.write('time_s,body,x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s\n')


# YADE takes half the mean radius for R1 R2 / (R1 + R2), which is right for equal grains alone.
def limit_rolling_of_ball():
    for contact in ball.intrs():
        if contact.isReal:
            grain = O.bodies[contact.id1 if contact.id2 == ball.id else contact.id2]
            arm = grain.shape.radius * ball.shape.radius / (grain.shape.radius + ball.shape.radius)
            contact.phys.maxBendPl = 2 * parameters['rolling_resistance'] * arm


O.engines = O.engines + [PyRunner(command='limit_rolling_of_ball()', iterPeriod=1)]
write_grains = write_snapshot


def write_snapshot(file, step):
    write_grains(file, step)
    track.write('%.10g,ball,%.10g,%.10g,%.10g,%.10g,%.10g,%.10g\n' % (step * O.dt, *ball.state.pos, *ball.state.vel))
    track.flush()


