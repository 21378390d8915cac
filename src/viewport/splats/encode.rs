//! One batch of cameras as commands: project, sort by depth, list per tile, blend.

use super::buffers::{Growing, PassSettings};
use super::pipelines::{DIGIT_BITS, GROUP, Pipelines, SORT_BLOCK};

/// Lists and intermediate results of a batch; none of them outlives it.
#[derive(Debug)]
pub(super) struct SplatWorkspace {
    pub settings: PassSettings,
    pub ledger: Growing,
    items: [Growing; 2],
    pairs: [Growing; 2],
    splats: Growing,
    ranges: Growing,
}

/// How large a batch is.
#[derive(Clone, Copy, Debug)]
pub(super) struct SplatBatchSize {
    pub gaussians: u32,
    pub views: u32,
    pub tiles: [u32; 2],
    /// Touches of splats and tiles that there is room for.
    pub room: u32,
    pub key_bits: u32,
}

/// Input and output buffers of a batch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Data<'a> {
    pub batch: &'a wgpu::Buffer,
    pub gaussians: &'a wgpu::Buffer,
    pub maps: &'a wgpu::Buffer,
}

/// Numbers at the head of the ledger: items, items before the last scan, touches (also those
/// without room), nothing.
pub(super) const LEDGER_BYTES: u64 = 16;
/// A tile and a splat.
pub(super) const PAIR_BYTES: u64 = 8;
/// A splat in `shaders/shared/splat.wgsl`.
pub(super) const SPLAT_BYTES: u64 = 32;

impl SplatBatchSize {
    fn items(&self) -> u32 {
        self.gaussians * self.views
    }

    fn all_tiles(&self) -> u32 {
        self.tiles[0] * self.tiles[1] * self.views
    }
}

impl SplatWorkspace {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> SplatWorkspace {
        let storage = wgpu::BufferUsages::STORAGE;
        let (from, to) = (wgpu::BufferUsages::COPY_SRC, wgpu::BufferUsages::COPY_DST);
        SplatWorkspace {
            settings: PassSettings::new(device, queue),
            ledger: Growing::new("splat ledger", storage | from | to),
            items: [(); 2].map(|()| Growing::new("splat items", storage | from | to)),
            pairs: [(); 2].map(|()| Growing::new("splat pairs", storage)),
            splats: Growing::new("splats", storage),
            ranges: Growing::new("splat ranges", storage | to),
        }
    }

    pub fn clear(&mut self) {
        let SplatWorkspace {
            ledger,
            items,
            pairs,
            splats,
            ranges,
            ..
        } = self;
        let all = [ledger, splats, ranges].into_iter().chain(items).chain(pairs);
        all.for_each(Growing::clear);
    }

    /// Records everything from Gaussians to maps. `maps` has room for all of the batch's cameras.
    pub fn encode(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        encoder: &mut wgpu::CommandEncoder,
        pipelines: &Pipelines,
        data: Data<'_>,
        shape: SplatBatchSize,
    ) {
        let (items, tiles) = (u64::from(shape.items()), u64::from(shape.all_tiles()));
        let room = u64::from(shape.room);
        let sort_blocks = items.max(room).div_ceil(SORT_BLOCK.into());
        let sums = (sort_blocks << DIGIT_BITS).max(items.div_ceil(GROUP.into()));
        let ledger = self.ledger.at_least(device, LEDGER_BYTES + sums * 4);
        let items = self.items.each_mut().map(|b| b.at_least(device, items * 8));
        let pairs = self
            .pairs
            .each_mut()
            .map(|b| b.at_least(device, room * PAIR_BYTES));
        let splats = self
            .splats
            .at_least(device, u64::from(shape.items()) * SPLAT_BYTES);
        let ranges = self.ranges.at_least(device, tiles * 8);
        self.settings.set_room(queue, shape.room);
        queue.write_buffer(ledger, 0, bytemuck::bytes_of(&[shape.items(), 0, 0, 0]));
        encoder.clear_buffer(ranges, 0, None);

        let mut to = Recorder {
            device,
            pipelines,
            settings: &self.settings,
            ledger: whole(ledger),
            pass: encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("splats"),
                timestamp_writes: None,
            }),
        };
        let per_item = [shape.items().div_ceil(GROUP), 1, 1];
        to.run(
            &pipelines.project,
            &[
                (0, whole(data.batch)),
                (1, whole(data.gaussians)),
                (2, whole(items[0])),
            ],
            [shape.gaussians.div_ceil(GROUP), shape.views, 1],
        );
        let items = to.sort(items, shape.items(), shape.key_bits);
        to.run(
            &pipelines.place,
            &[
                (0, whole(data.batch)),
                (1, whole(data.gaussians)),
                (2, whole(items)),
                (3, whole(ledger)),
                (4, whole(splats)),
            ],
            per_item,
        );
        to.run(
            &pipelines.scan,
            &[(1, self.settings.touches()), (2, whole(ledger))],
            [1; 3],
        );
        to.run(
            &pipelines.emit,
            &[
                (0, whole(data.batch)),
                (2, whole(items)),
                (3, whole(ledger)),
                (5, whole(pairs[0])),
            ],
            per_item,
        );
        let pairs = to.sort(
            pairs,
            shape.room,
            u32::BITS - (shape.all_tiles() - 1).leading_zeros(),
        );
        to.run(
            &pipelines.mark,
            &[(3, whole(ledger)), (5, whole(pairs)), (6, whole(ranges))],
            [shape.room.div_ceil(GROUP), 1, 1],
        );
        to.run(
            &pipelines.blend,
            &[
                (0, whole(data.batch)),
                (1, whole(pairs)),
                (2, whole(ranges)),
                (3, whole(splats)),
                (4, whole(data.maps)),
            ],
            [shape.tiles[0], shape.tiles[1], shape.views],
        );
    }
}

/// A compute pass and the data that most of its steps need.
struct Recorder<'a> {
    device: &'a wgpu::Device,
    pipelines: &'a Pipelines,
    settings: &'a PassSettings,
    ledger: wgpu::BindingResource<'a>,
    pass: wgpu::ComputePass<'a>,
}

impl<'a> Recorder<'a> {
    fn run(
        &mut self,
        pipeline: &wgpu::ComputePipeline,
        bindings: &[(u32, wgpu::BindingResource<'_>)],
        [x, y, z]: [u32; 3],
    ) {
        let entries: Vec<_> = bindings
            .iter()
            .map(|(binding, resource)| wgpu::BindGroupEntry {
                binding: *binding,
                resource: resource.clone(),
            })
            .collect();
        let bind_group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        self.pass.set_pipeline(pipeline);
        self.pass.set_bind_group(0, &bind_group, &[]);
        self.pass.dispatch_workgroups(x, y, z);
    }

    /// Sorts the content of the first buffer by the lowest `bits` of the keys; returns the buffer with the result.
    /// Makes at least one pass, which also drops culled items.
    fn sort(&mut self, buffers: [&'a wgpu::Buffer; 2], room: u32, bits: u32) -> &'a wgpu::Buffer {
        let [mut from, mut to] = buffers;
        let blocks = [room.div_ceil(SORT_BLOCK), 1, 1];
        for digit in 0..bits.div_ceil(DIGIT_BITS).max(1) {
            let shared = [(1, self.settings.digit(digit)), (2, self.ledger.clone())];
            let [settings, ledger] = shared;
            let count = [settings.clone(), ledger.clone(), (3, whole(from))];
            self.run(&self.pipelines.count_digits, &count, blocks);
            self.run(&self.pipelines.scan, &[settings.clone(), ledger.clone()], [1; 3]);
            let scatter = [settings, ledger, (3, whole(from)), (4, whole(to))];
            self.run(&self.pipelines.scatter, &scatter, blocks);
            std::mem::swap(&mut from, &mut to);
        }
        from
    }
}

fn whole(buffer: &wgpu::Buffer) -> wgpu::BindingResource<'_> {
    buffer.as_entire_binding()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::splats::read;

    fn noise(i: u32) -> u32 {
        let v = i.wrapping_mul(0x9e37_79b9) ^ 0x5bd1_e995;
        (v ^ v >> 15).wrapping_mul(0x85eb_ca6b) ^ v >> 7
    }

    /// Row 43: the device's order is that of a stable sort on the processor, and what is culled is gone.
    #[test]
    fn row_43_depth_sort() {
        let (_, device, queue) = crate::headless_device().expect("an adapter");
        let pipelines = Pipelines::new(&device).expect("able");
        let settings = PassSettings::new(&device, &queue);
        const CULLED: u32 = u32::MAX;
        let sort = |keys: &[u32], bits: u32| -> Vec<[u32; 2]> {
            let items: Vec<[u32; 2]> = keys.iter().zip(0..).map(|(&k, i)| [k, i]).collect();
            let n = items.len() as u32;
            use wgpu::BufferUsages as U;
            let usage = U::STORAGE | U::COPY_DST | U::COPY_SRC;
            let mut buffers = [(); 2].map(|()| Growing::new("items", usage));
            let buffers = buffers
                .each_mut()
                .map(|b| b.at_least(&device, items.len() as u64 * 8));
            let mut ledger = Growing::new("ledger", usage);
            let blocks = u64::from(n.div_ceil(SORT_BLOCK)).max(1);
            let ledger = ledger.at_least(&device, LEDGER_BYTES + (blocks << DIGIT_BITS) * 4);
            let mut staging = Growing::new("staging", U::COPY_DST | U::MAP_READ);
            let staging = staging.at_least(&device, LEDGER_BYTES + items.len() as u64 * 8);
            queue.write_buffer(ledger, 0, bytemuck::bytes_of(&[n, 0, 0, 0]));
            queue.write_buffer(buffers[0], 0, bytemuck::cast_slice(&items));
            let mut encoder = device.create_command_encoder(&Default::default());
            let sorted = Recorder {
                device: &device,
                pipelines: &pipelines,
                settings: &settings,
                ledger: whole(ledger),
                pass: encoder.begin_compute_pass(&Default::default()).forget_lifetime(),
            }
            .sort(buffers, n, bits);
            encoder.copy_buffer_to_buffer(ledger, 0, staging, 0, LEDGER_BYTES);
            encoder.copy_buffer_to_buffer(sorted, 0, staging, LEDGER_BYTES, u64::from(n) * 8);
            queue.submit([encoder.finish()]);
            read::mapped(&device, staging, LEDGER_BYTES + u64::from(n) * 8, |words| {
                let count = words[0] as usize;
                bytemuck::cast_slice(&words[4..4 + 2 * count]).to_vec()
            })
            .expect("read back")
        };
        let plain = |keys: &[u32]| -> Vec<[u32; 2]> {
            let mut items: Vec<[u32; 2]> = keys.iter().zip(0..).map(|(&k, i)| [k, i]).collect();
            items.retain(|item| item[0] != CULLED);
            items.sort_by_key(|item| item[0]);
            items
        };
        for n in [0, 1, 2, 7, 8, 9, 1023, 1024, 1025, 70_001] {
            let wild: Vec<u32> = (0..n).map(noise).collect();
            assert_eq!(sort(&wild, 32), plain(&wild), "{n} wild");
            let gaps: Vec<u32> = wild
                .iter()
                .map(|&k| if k % 3 == 0 { CULLED } else { k >> 5 })
                .collect();
            assert_eq!(sort(&gaps, 27), plain(&gaps), "{n} with gaps");
            let few: Vec<u32> = wild.iter().map(|k| k % 50).collect();
            assert_eq!(sort(&few, 6), plain(&few), "{n} of few keys");
        }
        assert_eq!(sort(&[5; 5000], 3), plain(&[5; 5000]));
        assert!(sort(&[CULLED; 5000], 27).is_empty());
        // Depths as their bits: equal ones keep their order, subnormal and large ones have their place.
        let depths = [2.5f32, 1e-45, 1e12, 2.5, 0.2, 1e-45, 200.0, 2.5];
        let keys = depths.map(f32::to_bits);
        let order: Vec<u32> = sort(&keys, 31).iter().map(|item| item[1]).collect();
        assert_eq!(order, [1, 5, 4, 0, 3, 7, 6, 2]);
    }
}
