#include "denoise/neighbour_marks.h"

#include <stdlib.h>
#include <string.h>

static size_t words_of(uint32_t candidates)
{
    return candidates <= LMB_NEIGHBOUR_MARKS_MOST ? (candidates + 63) / 64 : 0;
}

lmb_result lmb_neighbour_marks_make(const lmb_neighbour_cells *cells, lmb_neighbour_marks *marks)
{
    *marks = (lmb_neighbour_marks){.first = malloc(((size_t)cells->cell_count + 1) * sizeof *marks->first)};
    if (!marks->first) {
        return LMB_ERROR_MEMORY;
    }
    size_t words = 0;
    for (uint32_t cell = 0; cell < cells->cell_count; ++cell) {
        lmb_neighbour_ranges ranges;
        lmb_neighbour_ranges_find(cells, cell, &ranges);
        marks->first[cell] = words;
        words += words_of(ranges.candidates) * (cells->first[cell + 1] - cells->first[cell]);
    }
    marks->first[cells->cell_count] = words;
    marks->word = calloc(words + 1, sizeof *marks->word);
    if (!marks->word) {
        lmb_neighbour_marks_free(marks);
        return LMB_ERROR_MEMORY;
    }
    return LMB_OK;
}

void lmb_neighbour_marks_free(lmb_neighbour_marks *marks)
{
    free(marks->first);
    free(marks->word);
    *marks = (lmb_neighbour_marks){.first = NULL};
}

/* NULL: it has none. */
static uint64_t *words_at(const lmb_neighbour_marks *marks, const lmb_neighbour_point *point)
{
    if (marks->first[point->cell] == marks->first[point->cell + 1]) {
        return NULL;
    }
    const size_t in_cell = point->rank - point->cells->first[point->cell];
    return marks->word + marks->first[point->cell] + in_cell * words_of(point->ranges->candidates);
}

void lmb_neighbour_marks_set(lmb_neighbour_marks *marks, const lmb_neighbour_point *point, const lmb_neighbours *found)
{
    uint64_t *const word = words_at(marks, point);
    if (!word) {
        return;
    }
    memset(word, 0, words_of(point->ranges->candidates) * sizeof *word);
    for (uint32_t i = 1; i < found->count; ++i) {
        word[found->candidate[i] / 64] |= UINT64_C(1) << found->candidate[i] % 64;
    }
}

bool lmb_neighbour_marks_get(const lmb_neighbour_marks *marks, const lmb_neighbour_point *point, lmb_neighbours *found)
{
    const uint64_t *const word = words_at(marks, point);
    const lmb_neighbour_ranges *const ranges = point->ranges;
    if (!word) {
        return false;
    }
    uint32_t count = 0, range = 0, before = 0; /* candidates of ranges before that one */
    found->rank[count++] = point->rank;
    for (uint32_t w = 0; w < words_of(ranges->candidates); ++w) {
        for (uint64_t rest = word[w]; rest != 0; rest &= rest - 1) {
            const uint32_t candidate = 64 * w + (uint32_t)__builtin_ctzll(rest);
            while (candidate - before >= ranges->end[range] - ranges->first[range]) {
                before += ranges->end[range] - ranges->first[range];
                ++range;
            }
            found->rank[count] = ranges->first[range] + (candidate - before);
            found->candidate[count++] = candidate;
        }
    }
    found->count = count;
    return true;
}
