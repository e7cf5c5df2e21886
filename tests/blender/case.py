"""What two renderers say of one sphere, and how far they are apart: ratios, errors and their noise.

Each renderer has two pictures with independent noise. Products of differences of independent pictures have no noise in
the mean, so that an error is told from it. Errors are those of blocks of 4 x 4 pixels that lie wholly in the sphere.
"""

BLOCK = 4
# Least cosines of the view that divide the sphere into its middle, a ring, and its limb.
RINGS = (0.8, 0.5, 0.0)


def blocks(picture):
    """The means of blocks of pixels."""
    rows, columns = (n // BLOCK for n in picture.shape[:2])
    parts = picture[: rows * BLOCK, : columns * BLOCK].reshape(rows, BLOCK, columns, BLOCK, -1)
    return parts.mean((1, 3))


class Pair:
    """Two pictures of one renderer with independent noise, and the processor seconds of one."""

    def __init__(self, pictures, seconds):
        self.pictures, self.seconds = pictures, seconds

    def mean(self, layer="beauty"):
        return sum(picture[layer] for picture in self.pictures) / 2

    def light(self, mask, layer="beauty"):
        """The mean light over a mask."""
        return self.mean(layer)[mask].mean(0)

    def error(self, mask, layer="beauty"):
        """The standard error of the mean light over a mask, relative to it, by the pixels' noise."""
        a, b = (picture[layer][mask] for picture in self.pictures)
        return ((a - b) ** 2).sum(0) ** 0.5 / (a + b).sum(0)

    def noise(self, mask):
        """The noise of a pixel of one picture, as root mean square of all channels relative to the mean."""
        a, b = (picture["beauty"][mask] for picture in self.pictures)
        return float((((a - b) ** 2).mean() / 2) ** 0.5 / ((a + b).mean() / 2))


class Case:
    """One sphere: pictures of ours and of Cycles, the pixels of the sphere and those beside it."""

    def __init__(self, kind, ours, theirs, mask, beside):
        self.kind, self.ours, self.theirs, self.mask, self.beside = kind, ours, theirs, mask, beside
        # Every fourth pixel, of which models by quadrature have layers; exact pictures of ours; cosines of the view.
        self.points = mask.copy()
        self.points[1::2] = self.points[:, 1::2] = False
        self.models, self.exact, self.cosines = {}, None, None
        # The noise of a pixel with one path, of ours and of Cycles.
        self.noise_of_one = None

    def ratio(self, layer="beauty", pair=None, mask=None):
        """Light of ours over that of Cycles, over the whole sphere or a mask, and its standard error."""
        pair, mask = pair or self.ours, self.mask if mask is None else mask
        errors = [one.error(mask, layer) for one in (pair, self.theirs)]
        ratio = pair.light(mask, layer) / self.theirs.light(mask, layer)
        return ratio, (errors[0] ** 2 + errors[1] ** 2) ** 0.5

    def errors(self, pair=None):
        """The relative mean squared error and the relMSE of blocks, without noise, each with its standard error."""
        inside = blocks(self.mask[..., None].astype(float))[..., 0] == 1
        mine, other = ([blocks(picture["beauty"])[inside] for picture in one.pictures]
                       for one in (pair or self.ours, self.theirs))
        product = (mine[0] - other[0]) * (mine[1] - other[1])
        scaled = product / (other[0] * other[1]).mean(0)
        relative = product / (((other[0] + other[1]) / 2) ** 2 + 0.01)
        return [(part.mean(0), part.std(0) / len(part) ** 0.5) for part in (scaled, relative)]

    def background(self):
        """The largest relative difference of the mean light beside the sphere."""
        return float(abs(self.ours.light(self.beside) / self.theirs.light(self.beside) - 1).max())

    def model(self, name, layer="beauty"):
        """The mean light of a model by quadrature."""
        return self.models[name][layer].mean(0)

    def over_model(self, name, layer="beauty"):
        """The light of ours, or of Cycles, over that of a model."""
        pair = self.theirs if name == "theirs" else self.ours
        return pair.light(self.points, layer) / self.model(name, layer)

    def rings(self):
        """The masks of RINGS."""
        masks, last = [], 2.0
        for least in RINGS:
            ring = self.mask.copy()
            ring[self.mask] = (self.cosines >= least) & (self.cosines < last)
            masks.append(ring)
            last = least
        return masks
