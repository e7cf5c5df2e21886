"""Spheres under an environment, made in Blender, exported as glTF, and rendered by its renderer Cycles.

One sphere stands in each scene, so that nothing but the environment lights it. Cycles is asked for what it is not by
default: no clamping, no blur of highlights, no adaptive samples, a filter of one pixel, and no end of paths but by
chance, so that its mean is that of its models.
"""

import bpy
import scene as blender

# The radius of each sphere and the place of the camera, m, with Z up.
RADIUS, EYE = 0.02, (0.048, -0.144, 0.048)
# The coefficients of the translucent spheres, 1/m, and their index.
ABSORBED, SCATTERED, INDEX = (2.0, 10.0, 40.0), (600.0, 600.0, 600.0), 1.4
# Base colors, roughness, and the index of what is no metal.
OPAQUE = {
    "metal": {"color": (0.944, 0.776, 0.373), "roughness": 0.3},
    "plastic": {"color": (0.1, 0.3, 0.6), "roughness": 0.4, "index": 1.5},
}
SHELL_ROUGHNESS = 0.3
# Samples of Cycles for each pixel and picture; random walks are dear, and their light is smooth.
SAMPLES = {"metal": 128, "plastic": 128, "rough": 48, "smooth": 32}
# The layers of Cycles: light that the first surface reflects diffusely, mirrors, or lets through.
PASSES = ("diffuse", "glossy", "transmission")


def medium():
    """The translucent spheres' medium as our programs read it."""
    return {
        "name": "Shell", "unit": "1/m", "sigma_a": list(ABSORBED), "sigma_s": list(SCATTERED), "g": 0, "eta": INDEX,
        "source": "made up",
    }


def material(kind):
    """The material of a sphere: `metal`, `plastic`, or a shell around a medium, `rough` or `smooth`."""
    made = blender.material(kind)
    node = made.node_tree.nodes["Principled BSDF"]
    node.distribution, inputs = "MULTI_GGX", node.inputs
    if kind in OPAQUE:
        stated = OPAQUE[kind]
        inputs["Base Color"].default_value = (*stated["color"], 1)
        inputs["Roughness"].default_value = stated["roughness"]
        inputs["Metallic"].default_value = 0 if "index" in stated else 1
    else:
        inputs["Base Color"].default_value = (1, 1, 1, 1)
        inputs["Roughness"].default_value = SHELL_ROUGHNESS if kind == "rough" else 0
        inputs["Transmission Weight"].default_value, inputs["IOR"].default_value = 1, INDEX
        fill(made.node_tree)
        made["medium"] = medium()
    return made


def fill(tree):
    """The medium of a shell as nodes of Blender."""
    inside = tree.nodes.new("ShaderNodeVolumeCoefficients")
    inside.inputs["Absorption Coefficients"].default_value = ABSORBED
    inside.inputs["Scatter Coefficients"].default_value = SCATTERED
    inside.inputs["Anisotropy"].default_value = 0
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    tree.links.new(inside.outputs["Volume"], output.inputs["Volume"])


def ball(made, name, radius, location=(0, 0, 0)):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=6, radius=radius, location=location)
    blender.given(made, name)
    bpy.ops.object.shade_smooth()


def make(kind, environment, pixels):
    """The scene of one sphere, seen from the front and a little above."""
    scene = blender.empty(pixels, pixels)
    ball(material(kind), "Sphere", RADIUS)
    if kind in OPAQUE:
        # Our programs want something translucent to sample: a grain far behind the camera.
        ball(blender.material("Grain", medium="marble"), "Grain", 1e-3, (-20, -20, 0))
    scene.camera = blender.camera("Camera", EYE, (0, 0, 0), 110)
    scene.camera.data.clip_start = 0.01
    world = scene.world = bpy.data.worlds.new("World")
    if world.node_tree is None:
        world.use_nodes = True
    picture = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
    picture.image = bpy.data.images.load(str(environment))
    picture.image.colorspace_settings.name = "Linear Rec.709"
    # Radiance is constant over each of its pixels, as our programs take it.
    picture.interpolation = "Closest"
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    world.node_tree.links.new(picture.outputs["Color"], background.inputs["Color"])


def eye():
    """The place of the camera as glTF has it, with Y up."""
    import numpy

    x, y, z = EYE
    return numpy.array([x, z, -y])


def pixels(environment):
    """The radiance of an environment by rows from the top, columns and channels."""
    import numpy

    picture = bpy.data.images.load(str(environment))
    picture.colorspace_settings.name = "Linear Rec.709"
    width, height = picture.size
    return numpy.array(picture.pixels[:]).reshape(height, width, -1)[::-1, :, :3]


def render(path, samples, seed):
    """The picture that Cycles makes of the scene, as OpenEXR with the layers of PASSES."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.seed = "CPU", samples, seed
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.pixel_filter_type, cycles.film_exposure = "BOX", 1
    for bounces in ("max", "diffuse", "glossy", "transmission", "volume", "transparent_max"):
        setattr(cycles, f"{bounces}_bounces", 1024)
    scene.render.threads_mode, scene.render.threads = "AUTO", 0
    scene.view_settings.view_transform = "Raw"
    layer = scene.view_layers[0]
    for name in PASSES:
        for part in ("direct", "indirect", "color"):
            setattr(layer, f"use_pass_{name}_{part}", True)
    image = scene.render.image_settings
    if hasattr(image, "media_type"):
        image.media_type = "MULTI_LAYER_IMAGE"
    image.file_format, image.color_depth = "OPEN_EXR_MULTILAYER", "32"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
