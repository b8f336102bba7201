/* Vertices at the same position, which meshes hold several of wherever normals or UVs break. */
#ifndef LMB_MESH_WELD_H
#define LMB_MESH_WELD_H

#include <lambent/scene.h>

/* Finds for each vertex the first at the same position. False: no memory. */
bool lmb_mesh_weld(const lmb_mesh *mesh, uint32_t *weld);

#endif
