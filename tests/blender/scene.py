"""Scenes as a user of Blender makes them, and their export: what docs/blender.md says to click.

The scenes are made in the Python module of Blender, bpy. `statue` is that of docs/blender.md, `lamps` a floor under
lamps of each kind, which Cycles, Blender's own renderer, renders too.
"""

import math

import bpy
from mathutils import Vector

# Kinds of lamps that glTF has, and emission.
LAMPS = ["POINT", "SPOT", "SUN", "EMISSION"]


def material(name, color=(0.8, 0.8, 0.8), emission=None, strength=0.0, dull=False, **properties):
    """A material of the node Principled BSDF with custom properties."""
    made = bpy.data.materials.new(name)
    if made.node_tree is None:
        made.use_nodes = True
    inputs = made.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value = (*color, 1)
    if dull:
        inputs["Roughness"].default_value, inputs["Specular IOR Level"].default_value = 1, 0
    if emission:
        inputs["Emission Color"].default_value = (*emission, 1)
        inputs["Emission Strength"].default_value = strength
    for key, value in properties.items():
        made[key] = value
    return made


def given(made, name):
    """The object that was made last gets a material and a name."""
    thing = bpy.context.object
    thing.name = name
    thing.data.materials.append(made)
    return thing


def facing(location, towards, axis):
    """The rotation that turns an axis of an object towards a point."""
    return (Vector(towards) - Vector(location)).to_track_quat(axis, "Y").to_euler()


def add(name, data, location, towards=None):
    """A lamp or a camera, which looks towards a point."""
    thing = bpy.data.objects.new(name, data)
    thing.location = location
    if towards is not None:
        thing.rotation_euler = facing(location, towards, "-Z")
    bpy.context.collection.objects.link(thing)
    return thing


def camera(name, location, towards, millimetres=50):
    data = bpy.data.cameras.new(name)
    data.lens = millimetres
    return add(name, data, location, towards)


def empty(width, height):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = width, height
    return scene


def export(path):
    """File > Export > glTF 2.0, with Apply Modifiers, Custom Properties, Cameras and Punctual Lights."""
    bpy.ops.export_scene.gltf(
        filepath=str(path), export_apply=True, export_extras=True, export_cameras=True, export_lights=True
    )


def stand(thing):
    """Moves an object, with its modifiers, onto the plane z = 0."""
    evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    thing.location.z -= min((evaluated.matrix_world @ vertex.co).z for vertex in mesh.vertices)
    evaluated.to_mesh_clear()


def statue():
    """A monkey of marble and a ball of a medium of its own on a table, with two lamps. Lengths are metres."""
    scene = empty(640, 480)
    bpy.ops.mesh.primitive_monkey_add(size=0.1, rotation=(math.radians(-30), 0, 0))
    monkey = given(material("Stone", medium="marble"), "Monkey")
    monkey.modifiers.new("Subdivision", "SUBSURF").levels = 2
    # The eyes of this mesh are open: the modifier makes one closed surface of all.
    remesh = monkey.modifiers.new("Remesh", "REMESH")
    remesh.mode, remesh.voxel_size, remesh.use_smooth_shade = "VOXEL", 0.0008, True
    monkey.modifiers.new("Smooth", "SMOOTH").iterations = 4
    stand(monkey)
    own = {"unit": "mm", "color": [0.25, 0.75, 0.35], "radius": [1.0, 4.0, 1.5], "eta": 1.4}
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.02, location=(0.075, -0.045, 0.02))
    given(material("Jelly", medium=own), "Ball")
    bpy.ops.object.shade_smooth()
    bpy.ops.mesh.primitive_plane_add(size=6)
    given(material("Table", (0.12, 0.1, 0.09)), "Table")
    key = bpy.data.lights.new("Key", "POINT")
    key.energy = 5
    add("Key", key, (0.35, -0.35, 0.45))
    bpy.ops.mesh.primitive_plane_add(size=0.3, location=(-0.4, 0.35, 0.3))
    window = given(material("Window", (0, 0, 0), (1.0, 0.8, 0.6), 10), "Window")
    window.rotation_euler = facing(window.location, (0, 0, 0.05), "Z")
    scene.camera = camera("Front", (0.16, -0.36, 0.15), (0.014, 0, 0.04))
    camera("Back", (0.27, 0.27, 0.13), (0.01, 0, 0.04))


def lamps(kind):
    """A white floor, a lamp of a kind, and beyond the picture a marble ball, so that the floor is none."""
    scene = empty(64, 48)
    bpy.ops.mesh.primitive_plane_add(size=4)
    given(material("Floor", (0.5, 0.5, 0.5), dull=True), "Floor")
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.2, location=(0, -8, 0))
    given(material("Stone", medium="marble"), "Ball")
    if kind == "EMISSION":
        bpy.ops.mesh.primitive_plane_add(size=0.5, location=(0, 0, 2), rotation=(math.pi, 0, 0))
        given(material("Lamp", (0, 0, 0), (1, 0.5, 0.25), 10, dull=True), "Lamp")
    else:
        data = bpy.data.lights.new("Lamp", kind)
        data.energy = 2 if kind == "SUN" else 100
        data.color = (1, 0.5, 0.25)
        add("Lamp", data, (0, 0, 2))
        if kind != "SUN":
            data.shadow_soft_size = 0
        if kind == "SPOT":
            # glTF has another falloff towards the edge of the cone: only its middle is seen.
            data.spot_size, data.spot_blend = math.radians(160), 0.05
    scene.camera = camera("Camera", (0, -3, 1.5), (0, 0, 0.2), 70)


def cycles(path):
    """The picture that Cycles makes of the scene, light once reflected, as OpenEXR."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples, scene.cycles.max_bounces = "CPU", 256, 1
    scene.cycles.use_denoising = False
    scene.view_settings.view_transform = "Raw"
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
