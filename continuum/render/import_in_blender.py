# Brings a frame of `talus export --format ply` into Blender 3.4 as a point cloud with colours, which Blender's own PLY reader
# leaves out: blender --python import_in_blender.py -- FRAME.ply RADIUS_M
import sys

import bpy
import numpy

kinds = {"float": "<f4", "uchar": "u1", "uint": "<u4"}


def read_points(path):
    """One row a point, with the file's properties as fields."""
    with open(path, "rb") as file:
        words = [file.readline().split()]
        while words[-1] != [b"end_header"]:
            words.append(file.readline().split())
        properties = [(w[2].decode(), kinds[w[1].decode()]) for w in words if w[0] == b"property"]
        return numpy.frombuffer(file.read(), numpy.dtype(properties))


def fields(points, names):
    return numpy.stack([points[name].astype("f4") for name in names], axis=1)


def point_material():
    material = bpy.data.materials.new("sand")
    material.use_nodes = True
    tree = material.node_tree
    colour = tree.nodes.new("ShaderNodeAttribute")
    colour.attribute_name = "colour"
    shader = tree.nodes["Principled BSDF"]
    shader.inputs["Roughness"].default_value = 0.9
    tree.links.new(colour.outputs["Color"], shader.inputs["Base Color"])
    return material


def add_points(points, radius):
    mesh = bpy.data.meshes.new("sand")
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", fields(points, "xyz").ravel())
    srgb = fields(points, ("red", "green", "blue")) / 255.0
    linear = numpy.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    colours = mesh.attributes.new("colour", "FLOAT_COLOR", "POINT")
    colours.data.foreach_set("color", numpy.insert(linear, 3, 1.0, axis=1).ravel())
    identities = mesh.attributes.new("identity", "INT", "POINT")
    identities.data.foreach_set("value", points["identity"].view("i4").ravel().copy())
    sand = bpy.data.objects.new("sand", mesh)
    bpy.context.collection.objects.link(sand)

    nodes = bpy.data.node_groups.new("points", "GeometryNodeTree")
    nodes.inputs.new("NodeSocketGeometry", "mesh")
    nodes.outputs.new("NodeSocketGeometry", "points")
    to_points = nodes.nodes.new("GeometryNodeMeshToPoints")
    to_points.inputs["Radius"].default_value = radius
    painted = nodes.nodes.new("GeometryNodeSetMaterial")
    painted.inputs["Material"].default_value = point_material()
    begin, end = nodes.nodes.new("NodeGroupInput"), nodes.nodes.new("NodeGroupOutput")
    nodes.links.new(begin.outputs[0], to_points.inputs[0])
    nodes.links.new(to_points.outputs[0], painted.inputs[0])
    nodes.links.new(painted.outputs[0], end.inputs[0])
    sand.modifiers.new("points", "NODES").node_group = nodes
    return sand


path, size = sys.argv[sys.argv.index("--") + 1:]
imported = add_points(read_points(path), float(size))
print(f"{path}: {len(imported.data.vertices)} points")
