/* What finding regions goes through: cells, what is seen in those that geometry touches, groups of corners. */
#ifndef LMB_REGIONS_INTERNAL_H
#define LMB_REGIONS_INTERNAL_H

#include <lambent/regions.h>
#include <lambent/vector.h>

/* A cell is looked at from nodes, SIDE along each axis, of which the outermost lie just within its faces. */
enum {
    LMB_REGION_SIDE = 6,
    LMB_REGION_LINES = LMB_REGION_SIDE * LMB_REGION_SIDE, /* along each axis */
    LMB_REGION_NODES = LMB_REGION_LINES * LMB_REGION_SIDE,
    LMB_REGION_NONE = 255
};

/* Spacings that the outermost nodes keep from the faces. */
#define LMB_REGION_INSET 0.002f

/* Coordinate of a node along an axis, 0 to 1. */
float lmb_region_node(int i);

/* Coordinates of a node in its cell. */
void lmb_region_node_at(int node, float t[3]);

/* How far apart nodes that follow each other along an axis are in their numbers. */
static inline int lmb_region_stride(int axis)
{
    return axis == 0 ? 1 : axis == 1 ? LMB_REGION_SIDE : LMB_REGION_LINES;
}

/* Node `i` of one of the lines of nodes along an axis. */
static inline int lmb_region_line_node(int axis, int line, int i)
{
    const int other = axis == 0 ? LMB_REGION_SIDE : 1;
    const int last = axis == 2 ? LMB_REGION_SIDE : LMB_REGION_LINES;
    return i * lmb_region_stride(axis) + line % LMB_REGION_SIDE * other + line / LMB_REGION_SIDE * last;
}

/* Where a ray from a node ends at a surface. */
typedef struct lmb_region_end {
    uint8_t node, axis;
    bool unseen; /* the surface's back, which its material does not show */
    uint16_t at; /* along the axis, in 65535ths of the cell */
} lmb_region_end;

/* normal . t is the offset, in a cell's coordinates; the normal is of unit length. */
typedef struct lmb_region_plane {
    lmb_vec3 normal;
    float offset;
} lmb_region_plane;

/* Where something ends within a cell, or turns around an edge: a plane that divides a part of the cell in two from
 * there on. */
typedef struct lmb_region_extension {
    lmb_region_plane plane;
    lmb_region_plane rim; /* across the plane: below it things stand, above it there is nothing */
    float reach;          /* how far beyond the rim there is nothing; INFINITY: as far as the cell goes */
    float slope[2];       /* of the wedge, below the plane and above: how far it opens over a way from the rim */
    uint8_t label[2];     /* the region below the plane, and the one above */
    uint8_t faces;        /* bit 2 axis + side: the next cell is to be divided too, */
    uint8_t anchor[6];    /* [face] where this node sees */
    bool passed;          /* on by a cell beside: */
    lmb_vec3 from;        /* that node */
} lmb_region_extension;
enum { LMB_REGION_EXTENSIONS_MOST = 8 };

/* What was seen in a cell that a triangle touches, or that lies beside one. */
typedef struct lmb_region_look {
    uint8_t label[LMB_REGION_NODES]; /* the region of each node, or LMB_REGION_NONE */
    uint8_t count;                   /* of regions */
    uint64_t open[6]; /* [2 axis, 2 axis + 1: the low face, the high one] bit of a line: it goes on beyond the face */
    uint8_t real[LMB_CELL_REGIONS_MOST]; /* bit of a corner: the region sees its baked probe */
    bool failed;                         /* out of memory */
    uint32_t end_count, extension_count;
    lmb_region_end *end;
    lmb_region_extension *extension;
} lmb_region_look;

typedef struct lmb_region_cell {
    int32_t point[3];
    uint32_t level;
    uint32_t look;  /* its number, or UINT32_MAX: nothing touches it; then it is one region */
    uint32_t first; /* of its regions */
    uint32_t count; /* of regions */
    uint8_t probes; /* corners that have one */
} lmb_region_cell;

/* A corner of a finer region that touches a coarser one, at t in the coarser one's cell. */
typedef struct lmb_region_link {
    uint32_t fine, coarse; /* regions */
    uint32_t level, steps; /* of the finer one, and levels from it to the coarser one */
    uint8_t corner;        /* of the finer cell */
    float t[3];
} lmb_region_link;

/* A value that is made of others', of coarser levels. */
typedef struct lmb_region_hanging {
    int32_t value;
    uint32_t level;
    int32_t parent[8];
    float weight[8];
} lmb_region_hanging;

typedef struct lmb_region_work {
    const lmb_tracer *tracer;
    lmb_pool *pool;
    const lmb_progress *progress;
    lmb_probes *probes;
    lmb_region_cell *cell;
    uint32_t cell_count, cell_room;
    lmb_probe_index *index; /* [level] cells, by their first points */
    lmb_region_look *look;
    uint32_t *looked; /* [look] its cell */
    uint32_t look_count, look_room;
    uint32_t *looking; /* [task] look */
    lmb_vec3 *place;   /* [probe] where light is gathered, of baked ones that looked-at cells have at their corners */
    int32_t *placed;   /* these */
    uint32_t region_count;
    uint32_t *root;       /* [8 region + corner] a parent in the forest of corners that are one value */
    uint8_t *reached;     /* [region] somebody can be in it */
    int32_t (*corner)[8]; /* [region] probes and ghosts; -1: not reached */
    lmb_region_link *link;
    uint32_t link_count, link_room;
    uint64_t *rays;       /* [thread] */
    lmb_regions *regions; /* being made */
    lmb_regions_stats *stats;
} lmb_region_work;

/* A cell in the scene: t in it lies at first + t[0] step[0] + t[1] step[1] + t[2] step[2]. */
typedef struct lmb_region_frame {
    lmb_vec3 first, step[3];
    float spacing;
} lmb_region_frame;

lmb_region_frame lmb_region_frame_of(const lmb_probes *probes, const lmb_region_cell *cell);
lmb_vec3 lmb_region_position(const lmb_region_frame *frame, const float t[3]);

/* The other way around: a position in the coordinates of the cell. */
lmb_vec3 lmb_region_coordinates(const lmb_region_frame *frame, lmb_vec3 position);

/* The node nearest to a position, of those that are left, and where it is; it is then none of them any more.
 * @return -1: none is left */
int lmb_region_node_next(const lmb_region_frame *frame, lmb_vec3 position, bool left[LMB_REGION_NODES],
                         lmb_vec3 *place);

/* A place of a region that is just before a surface, where one of its corners that are to be fitted weighs most. */
typedef struct lmb_region_place {
    uint32_t region;
    float t[3];
} lmb_region_place;

struct lmb_regions {
    size_t point_count;
    lmb_region_point *point;
    size_t place_count;
    lmb_region_place *place;
    uint32_t region_count; /* that have anything to fit */
    int32_t (*corner)[8];  /* [region] */
    size_t hanging_count;
    lmb_region_hanging *hanging; /* those of coarser levels first */
    uint8_t *hangs;              /* [probe] */
    uint32_t unknown_count;
    int32_t *unknown;    /* probes and ghosts that are fitted */
    int32_t *unknown_of; /* [probe] which of them it is, or -1 */
};

/* Finds the cells that have a probe at any corner, or are beside them, and which of these triangles touch.
 * @return LMB_ERROR_MEMORY */
lmb_result lmb_region_cells_find(lmb_region_work *work);

/* Looks into the cells that are touched. @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_region_cells_look(lmb_region_work *work);

/* Surfaces along a line of nodes of a cell, from the node before it to the one after it: coordinates along the axis,
 * and hits, nearest first. */
enum { LMB_REGION_HITS_MOST = 64 };
typedef struct lmb_region_line {
    int count;
    float at[LMB_REGION_HITS_MOST];
    lmb_hit hit[LMB_REGION_HITS_MOST];
} lmb_region_line;
void lmb_region_line_trace(const lmb_tracer *tracer, const lmb_region_frame *frame, int axis, int line,
                           lmb_region_line *found, uint64_t *rays);

/* Whether a ray along the axis, or against it, meets a side that is not there to be seen: it is inside of something. */
bool lmb_region_is_unseen(const lmb_tracer *tracer, const lmb_hit *hit, bool against);

/* The last node of a line that is not beyond a coordinate; -1: all are. */
int lmb_region_node_before(float at);

/* What a node's line meets before the next node. */
typedef struct lmb_region_met {
    uint8_t node, axis, wall;
    float at; /* along the axis */
    uint32_t instance, triangle;
} lmb_region_met;

/* What stands between nodes of a cell: walls, each by its plane with the normal towards those who see it. */
enum { LMB_REGION_WALLS_MOST = 64, LMB_REGION_MET_MOST = 2 * 3 * LMB_REGION_LINES * (LMB_REGION_SIDE - 1) };
typedef struct lmb_region_walls {
    int count, met_count;
    lmb_region_plane wall[LMB_REGION_WALLS_MOST];
    lmb_region_met met[LMB_REGION_MET_MOST];
} lmb_region_walls;

/* Adds what a line meets. */
void lmb_region_walls_add(lmb_region_walls *walls, const lmb_tracer *tracer, const lmb_region_frame *frame, int axis,
                          int line, const lmb_region_line *found);

/* How far a place is above a plane. */
static inline float lmb_region_above(const lmb_region_plane *plane, const float t[3])
{
    return plane->normal.x * t[0] + plane->normal.y * t[1] + plane->normal.z * t[2] - plane->offset;
}

/* Nodes that are linked, each to the next one along an axis (bit of it), and the parts that they make. */
typedef struct lmb_region_parts {
    uint8_t link[LMB_REGION_NODES], part[LMB_REGION_NODES];
    int count, size[LMB_REGION_NODES];
} lmb_region_parts;

/* Finds the parts of what is linked. */
void lmb_region_parts_find(lmb_region_parts *parts);

/* Whether two walls meet at an edge of a triangle of the first one that lines meet. */
bool lmb_region_walls_meet(const lmb_region_walls *walls, int one, int other, const lmb_tracer *tracer,
                           const lmb_region_frame *frame);

/* The line beyond which a wall has ended, as a plane across it: that of an edge of its triangles which has all places
 * where the wall is met on one side, and all that are `open` on the other. Normal 0: there is none. */
lmb_region_plane lmb_region_rim_find(const lmb_region_walls *walls, int wall, const lmb_tracer *tracer,
                                     const lmb_region_frame *frame, const float (*open)[3], int open_count);

/* Finds what most needs to be divided of the parts that are not divided yet, and divides it in two.
 * @return the part that was; -1: nothing ends in the cell */
int lmb_region_extend(const lmb_region_walls *walls, const lmb_tracer *tracer, const lmb_region_frame *frame,
                      const uint64_t open[6], const lmb_region_parts *parts, const bool divided[LMB_REGION_NODES],
                      uint8_t link[LMB_REGION_NODES], lmb_region_extension *extension);

/* Divides a part in two by an extension's plane, and limits its reach to what the cell leaves it.
 * @return false: it is none, or more, and nothing is divided */
bool lmb_region_divide(const lmb_region_parts *parts, int part, lmb_region_extension *extension,
                       uint8_t link[LMB_REGION_NODES]);

/* Gives up extensions that would leave a step at a face. */
void lmb_region_extensions_settle(lmb_region_work *work);

/* The cells beyond a face: one, not finer, or up to four of the next finer level. @return how many */
int lmb_region_cells_beside(const lmb_region_work *work, const lmb_region_cell *cell, int face, uint32_t beside[4]);

/* Whether a cell's plane goes through another one. */
bool lmb_region_plane_crosses(const lmb_region_plane *plane, const lmb_region_cell *from, const lmb_region_cell *to);

/* Gives extensions to the cells beside that they are to divide too, and lists the looks of these, `*count`, in
 * work->looking: what was found in them is to be found anew. @return LMB_ERROR_MEMORY */
lmb_result lmb_region_extensions_pass(lmb_region_work *work, size_t *count);

/* Finds which corners of regions are one value, which regions can be reached, and gives each value a probe of the
 * lattice, or a ghost that is added to the probes. @return LMB_ERROR_MEMORY */
lmb_result lmb_region_corners_name(lmb_region_work *work);

/* Finds which corners of regions touch those of coarser levels. */
lmb_result lmb_region_levels_link(lmb_region_work *work);

/* Finds the values that hang on coarser levels, once cells are cut. @return LMB_ERROR_MEMORY */
lmb_result lmb_region_hanging_find(lmb_region_work *work);

/* Trilinear weights of corners. */
static inline void lmb_region_weights(const float t[3], float weight[8])
{
    for (int i = 0; i < 8; ++i) {
        weight[i] = (i & 1 ? t[0] : 1.0f - t[0]) * (i & 2 ? t[1] : 1.0f - t[1]) * (i & 4 ? t[2] : 1.0f - t[2]);
    }
}

/* A tree of planes that tells a cell's regions apart. */
typedef struct lmb_region_tree {
    uint32_t plane_count;
    lmb_cell_plane plane[LMB_CELL_PLANES_MOST];
    uint32_t strays;
} lmb_region_tree;

/* A number of 16383ths, as planes of cells have it. */
int16_t lmb_region_quantised(float value);

enum { LMB_REGION_WEDGE_PLANES = 5 };

/* Adds what parts two regions, `region` below an extension's plane and above it, in a cell that has no other planes
 * there: that plane, and a wedge beyond the rim. @return the number of the first plane */
uint8_t lmb_region_wedge_add(const lmb_region_extension *extension, const uint8_t region[2], lmb_region_tree *tree);

/* How wide the wedge of an extension opens, whose regions have their labels. */
void lmb_region_wedge_open(const lmb_region_look *look, lmb_region_extension *extension);

/* Labels are named by `name`; LMB_REGION_NONE: there is nobody in it. */
void lmb_region_tree_grow(const lmb_region_work *work, const lmb_region_cell *cell,
                          const uint8_t name[LMB_CELL_REGIONS_MOST], lmb_region_tree *tree, uint64_t *rays);

/* Cuts the cells that need it. @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_region_cells_cut(lmb_region_work *work);

/* Chooses points to gather at. @return LMB_ERROR_MEMORY */
lmb_result lmb_region_points_choose(lmb_region_work *work);

#endif
