// One position: behind the constants' reading, with LMB_VOLUME, LMB_PLACE, LMB_FOUND, LMB_FIND and LMB_BLEND.
void lmbItem(uint item)
{
    uint count = lmbInput(28u);
    if (item >= count) {
        return;
    }
    LMB_VOLUME v = volumeRead();
    LMB_PLACE place;
    vec3 position = vec3(lmbFloat(32u + 3u * item), lmbFloat(33u + 3u * item), lmbFloat(34u + 3u * item));
    bool inside = LMB_FIND(v, position, place);
    LMB_FOUND found = LMB_BLEND(v, place);
    lmbWrite(32u * item, inside ? 1.0 : 0.0);
    for (uint k = 0u; k < 9u; ++k) {
        lmbWrite(32u * item + 1u + k, found.radiance.c[k].x);
        lmbWrite(32u * item + 10u + k, found.radiance.c[k].y);
        lmbWrite(32u * item + 19u + k, found.radiance.c[k].z);
    }
    for (uint key = 0u; key < 4u; ++key) {
        lmbWrite(32u * item + 28u + key, found.visibility[key]);
    }
}
