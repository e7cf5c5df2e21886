//! Forecast for farms: how long a batch takes, and what limits it.

use crate::{
    markdown::{count, table, three, time},
    scale::cost::{Model, Size},
};

/// The resources of a farm.
struct Site {
    nodes: f64,
    cores: f64,
    /// Bytes of memory of a node.
    memory: f64,
    /// Bytes per second to one node, and of the shared storage.
    link: f64,
    storage: f64,
    /// Tasks that the queue starts per second, as measured by `make farm-test`.
    tasks: f64,
}

const SITE: Site = Site { nodes: 1000.0, cores: 16.0, memory: 64e9, link: 1.25e9, storage: 10e9, tasks: 10.0 };

impl Site {
    fn text(&self) -> String {
        let Site { nodes, cores, tasks, .. } = self;
        let [memory, link, storage] = [self.memory, self.link, self.storage].map(|bytes| bytes / 1e9);
        format!(
            "{nodes} nodes of {cores} cores and {memory} GB, {link} GB/s to each, a file system of {storage} GB/s that all \
             share, a queue that starts {tasks} tasks a second"
        )
    }
}

/// Number of views of the batch, 1920 x 1080 with 16 paths a pixel.
const VIEWS: f64 = 1e4;

const fn frame(samples: f64, views: u64) -> Size {
    Size { samples, width: 1920, height: 1080, spp: 16, views }
}

/// Kinds of batches: the samples of the cloud, and the views of one task.
const BATCHES: [Size; 6] =
    [frame(1e6, 1), frame(1e6, 10), frame(1e8, 1), frame(1e8, 10), frame(1e10, 1), frame(1e10, 10)];

/// Sizes of the clouds in the table.
const CLOUDS: [f64; 4] = [1e6, 1e8, 1e9, 1e10];

/// The second half of the document.
pub fn text(model: &Model) -> String {
    let farm = SITE.text();
    let [small, large] = [0, 4].map(|k| Batch::of(model, &BATCHES[k]));
    let full = model.gather(&frame(1e6, 1));
    let most = 0.5 * SITE.memory / (model.sampling(&frame(1e10, 1))[1] / 1e10);
    format!(
        "## Ten thousand views, ten thousand million samples, a thousand nodes\n\n\
         Not measured but said by the model, and beyond its range where K is above 20M. The farm is assumed: {farm}. Put in \
         your own numbers: each time below is an amount over a rate.\n\n\
         **Sampling.** A part takes at most half of a node's memory.\n\n{}\n\
         **Gathering** {VIEWS} views of 1920 x 1080 with 16 paths a pixel; every start reads its whole cloud once to check \
         it. Times are those of the whole batch, if nothing else held it up.\n\n{}\n\
         {}",
        table(
            &["K", "core time", "memory", "files", "parts", "time, a part a node"],
            &CLOUDS.map(|k| clouds(model, k))
        ),
        table(
            &[
                "K",
                "views a task",
                "core time",
                "computing",
                "queue",
                "reading",
                "writing",
                "a task's memory",
                "bound by"
            ],
            &BATCHES.map(|size| Batch::of(model, &size).row(&size)),
        ),
        advice(&small, &large, full, most),
    )
}

fn clouds(model: &Model, samples: f64) -> Vec<String> {
    let whole = model.sampling(&frame(samples, 1));
    let parts = (whole[1] / (0.5 * SITE.memory)).ceil().max(1.0);
    let part = model.sampling(&frame(samples / parts, 1));
    let wall = part[0] / SITE.cores + part[2] / SITE.link;
    vec![count(samples as u64), time(whole[0]), size(whole[1]), size(whole[2]), parts.to_string(), time(wall)]
}

/// The demand of a batch on each resource.
struct Batch {
    core_seconds: f64,
    /// Seconds of the whole farm: computing, queue, reading, writing.
    seconds: [f64; 4],
    /// Memory of one task, bytes, the mapped cloud included.
    memory: f64,
    written: f64,
    read: f64,
}

const BOUNDS: [&str; 4] = ["computing", "queue", "reading", "writing"];

impl Batch {
    fn of(model: &Model, size: &Size) -> Batch {
        let tasks = VIEWS / size.views as f64;
        let [processor, memory, images] = model.gather(size);
        let cloud = model.sampling(size)[2];
        let (core_seconds, written, read) = (tasks * processor, tasks * images, tasks * cloud);
        // A task runs on one node, and there may be fewer tasks than nodes.
        let busy = SITE.nodes.min(tasks);
        let through = |bytes: f64| (bytes / SITE.storage).max(bytes / (busy * SITE.link));
        let seconds = [core_seconds / (busy * SITE.cores), tasks / SITE.tasks, through(read), through(written)];
        Batch { core_seconds, seconds, memory, written, read }
    }

    fn bound(&self) -> &'static str {
        let longest = (0..4).max_by(|a, b| self.seconds[*a].total_cmp(&self.seconds[*b]));
        longest.map_or("", |k| BOUNDS[k])
    }

    fn row(&self, batch: &Size) -> Vec<String> {
        let mut row = vec![count(batch.samples as u64), batch.views.to_string(), time(self.core_seconds)];
        row.extend(self.seconds.map(time));
        row.extend([size(self.memory), format!("**{}**", self.bound())]);
        row
    }
}

/// Bytes in the unit that suits them.
fn size(bytes: f64) -> String {
    match bytes {
        b if b < 1e9 => format!("{} MB", three(b / 1e6)),
        b if b < 1e12 => format!("{} GB", three(b / 1e9)),
        b if b < 1e15 => format!("{} TB", three(b / 1e12)),
        b => format!("{} PB", three(b / 1e15)),
    }
}

/// Advice to the user, with figures of the model.
fn advice(small: &Batch, large: &Batch, [view, memory, image]: [f64; 3], most: f64) -> String {
    let seconds = time(view / SITE.cores);
    format!(
        "What holds a batch up is hardly ever the computing, and so there is little to gain from more nodes before this is \
         set right:\n\n\
         * **The queue, with small clouds.** A view takes {seconds} of a whole node and the queue {} for each task. Give a \
         task many views: a list in one view file, so that the work of a task is ten times what its start costs. Then a \
         start's own cost (reading the scene, building the ray tree, checking the cloud) is paid once a list too.\n\
         * **Writing, after that.** An image with all layers is {}, the batch {}. Render to the node's own disk and copy \
         what you need: `oiiotool all.exr --ch R,G,B -o beauty.exr` keeps 3 of 28 channels.\n\
         * **Reading, with large clouds.** Each start reads its cloud once: {} for {VIEWS} starts off 10000M samples. Fewer \
         starts with longer lists divide that. A cloud that fits into a node's memory beside the tasks stays there, and comes \
         from storage once a node instead of once a start. One that does not is read again and again, which this model does \
         not count: choose K so that the cloud fits, or render each part's image by itself (`gather part7.cloud`, other `--seed`) and average: the mean \
         of images of independent parts is unbiased.\n\
         * **Memory, in sampling.** Half of the {} GB of a node hold {} samples: larger clouds are drawn in parts \
         (`--shard`, [guide.md](../guide.md#big-clouds)), each on a node of its own, and gathered together. An image of 1920 x 1080 \
         takes {} to gather; `gather` asks for 1280 bytes a pixel before it starts, so 64 GB do for 50 million pixels, and \
         larger images are rendered in crops.\n\n\
         What to set:\n\n\
         * `SAMPLES`: no more than `sample-surface --target-error` says. The error of a cloud alone falls faster than 1/K and \
         is soon below that of the paths ([speed.md](speed.md): 0.3 % at 1.6M samples for the bunny in marble); 10000M are \
         for surfaces of thousands of mean free paths each way.\n\
         * Views a task: ten or more, as long as there are as many tasks as nodes.\n\
         * `THREADS`: few, and as many tasks on a node as they leave room for in its memory: on two cores two tasks of one \
         thread are done 4 % sooner than one after the other with two (figure, 1M samples, 384 x 384, 8 paths).\n\
         * `make -j`: as many as tasks can run at once.\n",
        time(1.0 / SITE.tasks),
        size(image),
        size(small.written),
        size(large.read),
        SITE.memory / 1e9,
        count((most / 1e6).floor() as u64 * 1_000_000),
        size(memory),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_have_a_unit() {
        assert_eq!([2.5e6, 3e9, 4.56e13, 7e16].map(size), ["2.50 MB", "3.00 GB", "45.6 TB", "70.0 PB"]);
    }

    /// By hand: 1000 tasks of 16 000 core seconds each.
    #[test]
    fn the_longest_of_four_binds() {
        let seconds = [1000.0, 100.0, 30.0, 80.0];
        let batch = Batch { core_seconds: 1.6e7, seconds, memory: 0.0, written: 0.0, read: 0.0 };
        assert_eq!(batch.bound(), "computing");
    }
}
