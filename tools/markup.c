#include "markup.h"

void markup_text(FILE *page, const char *text)
{
    for (; *text; ++text) {
        if (*text == '<' || *text == '>' || *text == '&') {
            fprintf(page, "&#%d;", *text);
        } else {
            fputc(*text, page);
        }
    }
}
