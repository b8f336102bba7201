// What a browser's WebGL 2 makes of compressed textures (tests/test_browser_textures.c). Behind a script that defines
// `textures`, an array of {name, code, width, height, layers, levels, channels, data, starts}: the blocks as hexadecimal
// bytes, level by level, in each layer by layer; `code` is WebGL's of the format. For each, show() adds a line of its
// name, sides, layers, levels and channels to the page's <pre>, and one of all texels in the same order, their channels
// as the hexadecimal bits of floats.
'use strict';

const gl = document.createElement('canvas').getContext('webgl2');
const extensions = ['EXT_texture_compression_rgtc', 'EXT_texture_compression_bptc', 'EXT_color_buffer_float'];
const missing = gl ? extensions.filter((name) => !gl.getExtension(name)) : ['webgl2'];

function say(line) {
    document.getElementById('seen').textContent += line + '\n';
}

function bytesOf(hexadecimal) {
    return Uint8Array.from(hexadecimal.match(/../g), (two) => parseInt(two, 16));
}

function side(texels, level) {
    return Math.max(texels >> level, 1);
}

// A program that shows texels of a level and layer as they are.
function programOf(gl, array) {
    const program = gl.createProgram();
    const sources = [[gl.VERTEX_SHADER, `#version 300 es
        void main() {
            gl_Position = vec4(vec2(gl_VertexID % 2, gl_VertexID / 2) * 4.0 - 1.0, 0.0, 1.0);
        }`], [gl.FRAGMENT_SHADER, `#version 300 es
        precision highp float;
        precision highp sampler2DArray;
        uniform highp ${array ? 'sampler2DArray' : 'sampler2D'} image;
        uniform int layer, level;
        out vec4 texel;
        void main() {
            ivec2 at = ivec2(gl_FragCoord.xy);
            texel = texelFetch(image, ${array ? 'ivec3(at, layer)' : 'at'}, level);
        }`]];
    for (const [kind, source] of sources) {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, source);
        gl.compileShader(shader);
        gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    return program;
}

// Draws every level and layer into floats.
function texelsShown(gl, image, array, texture) {
    const program = programOf(gl, array), target = gl.createTexture(), frame = gl.createFramebuffer();
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, target);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, texture.width, texture.height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(array ? gl.TEXTURE_2D_ARRAY : gl.TEXTURE_2D, image);
    gl.useProgram(program);
    gl.bindVertexArray(null);
    gl.disable(gl.BLEND);
    gl.disable(gl.DEPTH_TEST);
    gl.disable(gl.CULL_FACE);
    gl.disable(gl.SCISSOR_TEST);
    gl.uniform1i(gl.getUniformLocation(program, 'image'), 0);
    const bits = [];
    for (let level = 0; level < texture.levels; ++level) {
        const width = side(texture.width, level), height = side(texture.height, level);
        for (let layer = 0; layer < texture.layers; ++layer) {
            gl.viewport(0, 0, width, height);
            gl.uniform1i(gl.getUniformLocation(program, 'layer'), layer);
            gl.uniform1i(gl.getUniformLocation(program, 'level'), level);
            gl.drawArrays(gl.TRIANGLES, 0, 3);
            const floats = new Float32Array(4 * width * height);
            gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, floats);
            new Uint32Array(floats.buffer).forEach((value, i) => {
                if (i % 4 < texture.channels) {
                    bits.push(value.toString(16).padStart(8, '0'));
                }
            });
        }
    }
    return bits.join('');
}

function show(gl, how, image, array, texture) {
    const texels = texelsShown(gl, image, array, texture), error = gl.getError();
    if (error) {
        say(`failed ${how} ${texture.name}: WebGL error ${error}`);
        return;
    }
    say(`${how} ${texture.name} ${texture.width} ${texture.height} ${texture.layers} ${texture.levels} ${texture.channels}`);
    say(texels);
}

// The blocks as they are, in a texture of layers.
function blocksShow(texture) {
    const image = gl.createTexture(), bytes = bytesOf(texture.data);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, image);
    gl.texStorage3D(gl.TEXTURE_2D_ARRAY, texture.levels, texture.code, texture.width, texture.height, texture.layers);
    gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MIN_FILTER, gl.NEAREST_MIPMAP_NEAREST);
    for (let level = 0; level < texture.levels; ++level) {
        const end = level + 1 < texture.levels ? texture.starts[level + 1] : bytes.length;
        gl.compressedTexSubImage3D(gl.TEXTURE_2D_ARRAY, level, 0, 0, 0, side(texture.width, level),
            side(texture.height, level), texture.layers, texture.code, bytes.subarray(texture.starts[level], end));
    }
    show(gl, 'blocks', image, true, texture);
}

say(''); // what follows are lines of their own
if (missing.length > 0) {
    say('missing ' + missing.join(' '));
} else {
    textures.forEach(blocksShow);
}
