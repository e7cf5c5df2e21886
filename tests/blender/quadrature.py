"""What a rough opaque sphere reflects of an environment, by two models of the same microfacets, without chance.

The integral over all directions is a sum over the pixels of the environment, whose radiance is constant. `ours` is the
model of docs/method.md 18.2 and 18.3, `theirs` that of Cycles; a third program of neither renderer, so that a
difference of two pictures is split into models and faults.
"""

import numpy

# Cosines of the tables of albedos.
COSINES = numpy.linspace(0, 1, 129)[1:]


def fresnel(cosine, index):
    """The share of unpolarized light that a smooth boundary reflects."""
    beyond = numpy.sqrt(1 - (1 - cosine**2) / index**2)
    s = (cosine - index * beyond) / (cosine + index * beyond)
    p = (beyond - index * cosine) / (beyond + index * cosine)
    return (s * s + p * p) / 2


def schlick(cosine, normal):
    return normal + (1 - normal) * (1 - cosine) ** 5


def slopes(cosine, alpha):
    """Smith's Λ of GGX."""
    return (numpy.sqrt(1 + alpha**2 * (1 / cosine**2 - 1)) - 1) / 2


def distribution(cosine, alpha):
    return alpha**2 / (numpy.pi * (1 - (1 - alpha**2) * cosine**2) ** 2)


def single(cosine, alpha, reflectance):
    """The albedos of single reflections at one cosine: of mirrors, and of what has a reflectance."""
    # Half vectors are spread like tan²θ of GGX, whose steps hold equal shares of their area.
    u, phi = numpy.meshgrid((numpy.arange(256) + 0.5) / 256, (numpy.arange(256) + 0.5) / 256 * 2 * numpy.pi)
    z = numpy.sqrt((1 - u) / (1 + (alpha**2 - 1) * u))
    r = numpy.sqrt(1 - z * z)
    towards = numpy.sqrt(1 - cosine**2) * r * numpy.cos(phi) + cosine * z
    light = 2 * towards * z - cosine
    seen = (towards > 0) & (light > 0)
    towards, light, z = towards[seen], light[seen], z[seen]
    share = towards / (cosine * z * (1 + slopes(cosine, alpha) + slopes(light, alpha))) / u.size
    return share.sum(), (share * reflectance(towards)).sum()


class Layer:
    """A layer of microfacets with a reflectance, by its albedos at COSINES."""

    def __init__(self, alpha, reflectance):
        self.alpha, self.reflectance = alpha, reflectance
        both = [single(cosine, alpha, reflectance) for cosine in COSINES]
        self.all, self.reflected = (numpy.array(column) for column in zip(*both))
        self.mean = self.over(self.all)
        mean = self.over(reflectance(COSINES))
        self.returned = mean * mean * self.mean / (1 - mean * (1 - self.mean))
        self.scale = mean * self.mean / (1 - mean * (1 - self.mean))

    @staticmethod
    def over(values):
        """The mean over directions of diffuse light."""
        return float((values * COSINES).sum() / COSINES.sum())

    def ours(self, mirrored, out, light):
        """Several reflections as a lobe of their own, by Kulla and Conty."""
        lost = [1 - numpy.interp(c, COSINES, self.all) for c in (out, light)]
        return mirrored + self.returned * lost[0] * lost[1] / (numpy.pi * (1 - self.mean))

    def theirs(self, mirrored, out, light):
        """Several reflections as a factor of single ones, by Turquin."""
        all_ = numpy.interp(out, COSINES, self.all)
        return mirrored * (1 + self.scale * (1 - all_) / all_)

    def through(self, cosine, model):
        """The share of light that the layer does not reflect, to a viewer at a cosine."""
        lost = 1 - self.all
        several = self.returned * lost if model == "ours" else self.scale * lost / self.all * self.reflected
        return numpy.interp(cosine, COSINES, 1 - self.reflected - several)

    def lobe(self, model, out, light, towards, normal):
        shadows = 1 + slopes(out, self.alpha) + slopes(light, self.alpha)
        mirrored = self.reflectance(towards) * distribution(normal, self.alpha) / (4 * out * light * shadows)
        return getattr(self, model)(mirrored, out, light)


def directions(height, width):
    """Directions of the pixels of an environment, +Y up, and their solid angles."""
    theta = (numpy.arange(height) + 0.5) / height * numpy.pi
    phi = ((numpy.arange(width) + 0.5) / width - 0.5) * 2 * numpy.pi
    theta, phi = (a.ravel() for a in numpy.meshgrid(theta, phi, indexing="ij"))
    sine = numpy.sin(theta)
    towards = numpy.stack([sine * numpy.cos(phi), numpy.cos(theta), sine * numpy.sin(phi)], 1)
    return towards.astype("f4"), sine * 2 * numpy.sin(numpy.pi / height / 2) * 2 * numpy.pi / width


def integrate(light, view, normals, layer, model, albedo):
    """What points with these normals reflect towards their viewers, mirrored and diffuse, for each channel."""
    towards, weights = light
    shape = (len(normals), weights.shape[0])
    mirrored, diffuse = numpy.zeros(shape), numpy.zeros(shape)
    mean = layer.over(layer.through(COSINES, "ours"))
    for at, (n, v) in enumerate(zip(normals.astype("f4"), view.astype("f4"))):
        cosines = towards @ n
        front = cosines > 1e-4
        l, w, cosines = towards[front], weights[:, front] * cosines[front], cosines[front]
        half = l + v
        length = numpy.sqrt(numpy.einsum("ij,ij->i", half, half))
        out = max(float(n @ v), 1e-3)
        mirrored[at] = w @ layer.lobe(model, out, cosines, half @ v / length, half @ n / length)
        if albedo:
            back = layer.through(cosines, model) / mean if model == "ours" else numpy.ones_like(cosines)
            diffuse[at] = w @ back * layer.through(out, model) / numpy.pi
    return mirrored, diffuse


def reflected(stated, name, radiance, view, normals):
    """The layers of light of points in three channels; `stated` has a color, a roughness, and an index unless it is a
    metal. The model `exact` is `ours` with Fresnel's equations in place of Schlick's.
    """
    alpha, index, color = stated["roughness"] ** 2, stated.get("index"), numpy.array(stated["color"])
    model = "theirs" if name == "theirs" else "ours"
    towards, sizes = directions(*radiance.shape[:2])
    weights = (radiance.reshape(-1, 3).T * sizes).astype("f4")
    if index is None:
        layers = [Layer(alpha, lambda c, least=least: schlick(c, least)) for least in color]
        parts = [integrate((towards, weights[c : c + 1]), view, normals, layers[c], model, False) for c in range(3)]
        glossy, diffuse = (numpy.concatenate(part, 1) for part in zip(*parts))
    else:
        least = ((index - 1) / (index + 1)) ** 2
        layer = Layer(alpha, (lambda c: schlick(c, least)) if name == "ours" else (lambda c: fresnel(c, index)))
        glossy, diffuse = integrate((towards, weights), view, normals, layer, model, color.any())
        diffuse = diffuse * color
    return {"glossy": glossy, "diffuse": diffuse, "beauty": glossy + diffuse}
