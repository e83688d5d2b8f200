"""Tables between two marks of a page, <!-- NAME --> and <!-- /NAME -->, each alone on its line."""
import sys


def between(page, name):
    """The page's text before what is between the marks, that, and the text after it; the marks belong to the outer two."""
    text, begin, end = page.read_text(), f"<!-- {name} -->\n", f"<!-- /{name} -->\n"
    if text.count(begin) != 1 or text.count(end) != 1:
        sys.exit(f"{page} does not have the marks {begin.strip()} and {end.strip()} once each")
    before, rest = text.split(begin)
    inside, after = rest.split(end)
    return before + begin, inside, end + after


def write(page, name, wanted):
    before, _, after = between(page, name)
    page.write_text(before + wanted + after)


def check(page, name, wanted, renew):
    """End the program where the page says something else; `renew` is the command that mends it."""
    if between(page, name)[1] != wanted:
        sys.exit(f"{page}: the table of {name} is not what the results say; renew it with {renew}")
