"""What a picture by gnuplot says, and where: for the tests of pictures."""
import re
import xml.etree.ElementTree

SVG = "{http://www.w3.org/2000/svg}"
LETTER = 0.6  # of the size of a font, the width of a letter of those that are wide


def texts(path):
    return ["".join(t.itertext()).strip() for t in xml.etree.ElementTree.parse(path).getroot().iter(SVG + "text")]


def box(group, text):
    """(left, top, right, bottom), by the width that the text may have."""
    x, y, turned = re.match(r"translate\(([-\d.]+),([-\d.]+)\)(.*)", group.get("transform")).groups()
    size = float(group.get("font-size"))
    width = LETTER * size * len(text)
    left = {"start": 0, "middle": -width / 2, "end": -width}[group.get("text-anchor")]
    box = (left, -0.75 * size, left + width, 0.2 * size)
    if turned:  # upwards
        box = (box[1], -box[2], box[3], -box[0])
    return box[0] + float(x), box[1] + float(y), box[2] + float(x), box[3] + float(y)


def boxes(path):
    """[(text, box)]"""
    root = xml.etree.ElementTree.parse(path).getroot()
    found = [(g, "".join(t.itertext()).strip()) for g in root.iter(SVG + "g") for t in g.findall(SVG + "text")]
    return [(text, box(g, text)) for g, text in found if text]


def faults(path):
    """What cannot be read: texts that stand beyond the picture or on each other."""
    width, height = map(float, xml.etree.ElementTree.parse(path).getroot().get("viewBox").split()[2:])
    placed, found = boxes(path), []
    for i, (text, (left, top, right, bottom)) in enumerate(placed):
        if left < 0 or top < 0 or right > width or bottom > height:
            found.append(f"'{text}' is cut off")
        found += [f"'{text}' stands on '{other}'" for other, b in placed[:i] if left < b[2] and b[0] < right and top < b[3] and
                  b[1] < bottom]
    return found
