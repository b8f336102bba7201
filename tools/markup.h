/* Pages and pictures in mark-up: HTML, SVG. */
#ifndef LMB_TOOLS_MARKUP_H
#define LMB_TOOLS_MARKUP_H

#include <stdio.h>

/* Writes text that is no mark-up. */
void markup_text(FILE *page, const char *text);

#endif
