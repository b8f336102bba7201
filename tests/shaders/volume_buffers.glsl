// What shaders that sample volumes read and write: constants, a count of positions and they, then words; 32 numbers of
// each position. Behind the buffers' declarations.
uint lmbInput(uint index)
{
    return inputs[index];
}

float lmbFloat(uint index)
{
    return lmbAsFloat(inputs[index]);
}

void lmbWrite(uint index, float value)
{
    outputs[index] = value;
}

// Of the words behind the positions.
uint lmbWord(uint index)
{
    return inputs[32u + 3u * inputs[28u] + index];
}
