"""Bakes one level in Cycles, for tools/compare_cycles, which writes the job that this reads:

    blender -b --factory-startup -noaudio --python compare_cycles_blender.py -- JOB.json

The job names the level (.glb whose nodes have unique names and a second set of UVs), the places of its nodes in one
image, the environment, and the runs: samples, seed, file. Each run writes 3 x width x height little-endian floats, rows
from the top, NaN where nothing was baked, and prints one line "RUN samples seconds"."""
import json
import sys
import time

import bpy
import numpy

numpy.bool = bool  # Blender 3.4's importer asks for a name that newer numpy has dropped


def materials_make_diffuse(image):
    """Every surface Lambertian with its base colour and emission, as Lambent takes it; the image is the bake's target."""
    for material in bpy.data.materials:
        material.use_nodes = True
        tree = material.node_tree
        principled = next((node for node in tree.nodes if node.type == 'BSDF_PRINCIPLED'), None)
        output = next((node for node in tree.nodes if node.type == 'OUTPUT_MATERIAL'), None)
        if principled and output:
            diffuse = tree.nodes.new('ShaderNodeBsdfDiffuse')
            emission = tree.nodes.new('ShaderNodeEmission')
            both = tree.nodes.new('ShaderNodeAddShader')
            for source, target in (('Base Color', diffuse), ('Emission', emission)):
                socket = principled.inputs[source]
                if socket.is_linked:
                    tree.links.new(socket.links[0].from_socket, target.inputs['Color'])
                else:
                    target.inputs['Color'].default_value = socket.default_value
            emission.inputs['Strength'].default_value = principled.inputs['Emission Strength'].default_value
            tree.links.new(diffuse.outputs[0], both.inputs[0])
            tree.links.new(emission.outputs[0], both.inputs[1])
            tree.links.new(both.outputs[0], output.inputs['Surface'])
        target = tree.nodes.new('ShaderNodeTexImage')
        target.image = image
        tree.nodes.active = target


def world_make(environment, strength):
    world = bpy.data.worlds.new('world')
    bpy.context.scene.world = world
    world.use_nodes = True
    background = world.node_tree.nodes['Background']
    background.inputs[0].default_value = (0, 0, 0, 1)
    background.inputs[1].default_value = strength
    if environment:
        texture = world.node_tree.nodes.new('ShaderNodeTexEnvironment')
        texture.image = bpy.data.images.load(environment)
        texture.image.colorspace_settings.name = 'Linear'
        world.node_tree.links.new(texture.outputs[0], background.inputs[0])


def cycles_set_up(threads):
    scene = bpy.context.scene
    scene.render.engine = 'CYCLES'
    scene.render.threads_mode = 'FIXED'
    scene.render.threads = threads
    cycles = scene.cycles
    cycles.device = 'CPU'
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.sample_clamp_direct = 0
    cycles.sample_clamp_indirect = 0
    cycles.max_bounces = 64
    cycles.diffuse_bounces = 64
    cycles.glossy_bounces = 0
    cycles.transmission_bounces = 0
    cycles.caustics_reflective = False
    cycles.caustics_refractive = False
    cycles.min_light_bounces = 0
    cycles.light_sampling_threshold = 0
    scene.render.bake.margin = 0
    scene.render.bake.use_clear = False
    scene.render.bake.use_pass_direct = True
    scene.render.bake.use_pass_indirect = True
    scene.render.bake.use_pass_color = False


def level_join(places):
    """One object of all that has a place, its UVs those of the image: one bake call bakes it all."""
    for light in [item for item in bpy.data.objects if item.type == 'LIGHT']:
        bpy.data.objects.remove(light)
    bpy.ops.object.select_all(action='SELECT')
    bpy.ops.object.make_single_user(object=True, obdata=True)
    bpy.ops.object.select_all(action='DESELECT')
    joined = []
    for item in bpy.data.objects:
        if item.type != 'MESH':
            continue
        place = places.get(item.name)
        if place is None:
            continue
        layers = item.data.uv_layers
        layer = layers[1] if len(layers) > 1 else layers[0]
        layer.name = 'lightmap'
        flat = numpy.empty(2 * len(layer.data), numpy.float32)
        layer.data.foreach_get('uv', flat)
        uv = flat.reshape(-1, 2)
        uv[:, 0] = place['offset'][0] + place['scale'][0] * uv[:, 0]
        uv[:, 1] = 1 - (place['offset'][1] + place['scale'][1] * (1 - uv[:, 1]))  # Blender counts rows upwards
        layer.data.foreach_set('uv', uv.ravel())
        item.select_set(True)
        joined.append(item)
    bpy.context.view_layer.objects.active = joined[0]
    if len(joined) > 1:
        bpy.ops.object.join()
    layers = bpy.context.view_layer.objects.active.data.uv_layers
    layers.active = layers['lightmap']


def run(image, job, wanted):
    width, height = job['width'], job['height']
    empty = numpy.full((height * width, 4), -1, numpy.float32)
    image.pixels.foreach_set(empty.ravel())
    bpy.context.scene.cycles.samples = wanted['samples']
    bpy.context.scene.cycles.seed = wanted['seed']
    start = time.perf_counter()
    bpy.ops.object.bake(type='DIFFUSE', pass_filter={'DIRECT', 'INDIRECT'}, margin=0, use_clear=False)
    seconds = time.perf_counter() - start
    pixels = numpy.empty(height * width * 4, numpy.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(height, width, 4)[::-1, :, :3].copy()
    pixels[pixels[:, :, 0] < 0] = numpy.nan
    pixels.astype('<f4').tofile(wanted['file'])
    print('RUN', wanted['samples'], '%.4f' % seconds, flush=True)


def main():
    with open(sys.argv[sys.argv.index('--') + 1], encoding='utf-8') as file:
        job = json.load(file)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=job['level'])
    image = bpy.data.images.new('lightmap', job['width'], job['height'], alpha=False, float_buffer=True)
    image.colorspace_settings.name = 'Linear'
    if not bpy.data.materials:
        bpy.data.materials.new('none')
    for item in bpy.data.objects:
        if item.type == 'MESH' and not item.data.materials:
            item.data.materials.append(bpy.data.materials[0])
    materials_make_diffuse(image)
    world_make(job['environment'], job['strength'])
    cycles_set_up(job['threads'])
    level_join(job['places'])
    for wanted in job['runs']:
        run(image, job, wanted)


main()
