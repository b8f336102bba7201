// The same of files, by three.js and its loaders. Behind textures.js, and a script that defines `files`, an array of
// {name, data}: the file as hexadecimal bytes. Sides, layers and levels are what the loader says.
import * as THREE from 'three';
import {DDSLoader} from 'three/addons/loaders/DDSLoader.js';
import {KTX2Loader} from 'three/addons/loaders/KTX2Loader.js';
import {read} from 'three/addons/libs/ktx-parse.module.js';

const renderer = new THREE.WebGLRenderer();
const ktx2 = new KTX2Loader().detectSupport(renderer);
const FORMATS = {139: THREE.RED_RGTC1_Format, 141: THREE.RED_GREEN_RGTC2_Format, 143: THREE.RGB_BPTC_UNSIGNED_Format};
const BC6H = 143; // VkFormat
const CHANNELS = {[THREE.RED_RGTC1_Format]: 1, [THREE.RED_GREEN_RGTC2_Format]: 2, [THREE.RGB_BPTC_UNSIGNED_Format]: 3};

// Of what KTX2Loader does not take, by the parser that it has: BC6H, and layers.
function parsed(container) {
    const levels = container.levels.map((level, i) => ({
        data: level.levelData,
        width: side(container.pixelWidth, i),
        height: side(container.pixelHeight, i)
    }));
    const format = FORMATS[container.vkFormat], width = container.pixelWidth, height = container.pixelHeight;
    return container.layerCount > 1
        ? new THREE.CompressedArrayTexture(levels, width, height, container.layerCount, format)
        : new THREE.CompressedTexture(levels, width, height, format);
}

async function textureOf(file) {
    const bytes = bytesOf(file.data);
    if (file.name.endsWith('.dds')) {
        const dds = new DDSLoader().parse(bytes.buffer, true);
        return new THREE.CompressedTexture(dds.mipmaps, dds.width, dds.height, dds.format);
    }
    const container = read(bytes);
    if (container.vkFormat === BC6H || container.layerCount > 1) {
        return parsed(container);
    }
    return new Promise((done, failed) => ktx2.parse(bytes.buffer, done, failed));
}

for (const file of files) {
    try {
        const texture = await textureOf(file), array = texture.isCompressedArrayTexture === true;
        texture.needsUpdate = true;
        renderer.initTexture(texture);
        show(renderer.getContext(), 'three.js', renderer.properties.get(texture).__webglTexture, array, {
            name: file.name,
            width: texture.image.width,
            height: texture.image.height,
            layers: array ? texture.image.depth : 1,
            levels: texture.mipmaps.length,
            channels: CHANNELS[texture.format]
        });
    } catch (error) {
        say(`failed three.js ${file.name}: ${error.message}`);
    }
}
