//! Instance, device and queue; which devices there are, and what they can do.

use super::{GpuError, Named, validation};
use crate::cache::{Cache, hash};
use ash::{ext, khr, vk};
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use std::collections::BTreeMap;
use std::ffi::{CStr, CString};
use std::sync::{Arc, Mutex};

const LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// How to open a device.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Core and synchronization validation; an error where the layer is absent.
    pub validate: bool,
    /// Index in the list of [`Gpu::devices`], or part of a name; none: the fastest kind there is.
    pub device: Option<String>,
}

/// One physical device.
#[derive(Clone, Debug, serde::Serialize)]
pub struct DeviceInfo {
    /// Position in the loader's list.
    pub index: usize,
    /// Device name.
    pub name: String,
    /// Driver name and version.
    pub driver: String,
    /// Vulkan version.
    pub api: String,
    /// discrete, integrated, virtual, cpu or other.
    pub kind: &'static str,
    /// Why it cannot be used; none if it can.
    pub unusable: Option<String>,
    /// Nanoseconds per timestamp tick; 0 if the queue has no timestamps.
    pub timestamp_period: f32,
    /// It draws points of several pixels.
    pub large_points: bool,
}

/// Pipelines of earlier runs.
struct Kept {
    cache: Cache,
    /// Device, driver and every shader.
    key: u64,
    /// What was there.
    found: Vec<u8>,
}

/// An open device. Owners hold it by `Arc`.
pub struct Gpu {
    pub(super) device: ash::Device,
    pub(super) push: khr::push_descriptor::Device,
    pub(super) debug: Option<ext::debug_utils::Device>,
    pub(super) queue: vk::Queue,
    pub(super) family: u32,
    pub(super) allocator: Mutex<Option<Allocator>>,
    pub(super) timestamp_bits: u32,
    pub(super) cache: vk::PipelineCache,
    kept: Option<Kept>,
    live: Mutex<BTreeMap<u64, String>>,
    messages: validation::Messages,
    info: DeviceInfo,
    limits: vk::PhysicalDeviceLimits,
    physical: vk::PhysicalDevice,
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    instance: ash::Instance,
    _entry: ash::Entry,
}

impl Gpu {
    /// Opens the device that `options` names, or the best one: discrete before integrated before software.
    ///
    /// # Errors
    /// [`GpuError::NoDevice`] names what every device lacks; [`GpuError::NoValidation`] where the layer is absent.
    pub fn open(options: &Options) -> Result<Arc<Gpu>, GpuError> {
        Self::open_with(options, None)
    }

    /// As [`Gpu::open`]; what is dear to make is looked for in `cache`, and kept there.
    ///
    /// # Errors
    /// As [`Gpu::open`].
    pub fn open_with(options: &Options, cache: Option<Cache>) -> Result<Arc<Gpu>, GpuError> {
        let (entry, instance) = instance(options.validate)?;
        let messages = validation::Messages::default();
        let messenger = if options.validate { Some(messenger(&entry, &instance, &messages)?) } else { None };
        let candidates = enumerate(&instance)?;
        let wanted = |(_, info): &&(vk::PhysicalDevice, DeviceInfo)| match &options.device {
            None => info.unusable.is_none(),
            Some(text) => match text.parse::<usize>() {
                Ok(index) => info.index == index,
                Err(_) => info.name.to_lowercase().contains(&text.to_lowercase()),
            },
        };
        let rank = |info: &DeviceInfo| match info.kind {
            "discrete" => 0,
            "integrated" => 1,
            "virtual" => 2,
            _ => 3,
        };
        let chosen = candidates.iter().filter(wanted).min_by_key(|(_, info)| rank(info)).cloned();
        let Some((physical, info)) = chosen else {
            let list: Vec<String> = candidates
                .iter()
                .map(|(_, i)| format!("{} ({})", i.name, i.unusable.as_deref().unwrap_or("usable")))
                .collect();
            let list = if list.is_empty() { "the loader finds no driver".to_owned() } else { list.join("; ") };
            return Err(GpuError::NoDevice(match &options.device {
                Some(name) => format!("--device {name} matches none of: {list}"),
                None => format!("{list} (Debian: mesa-vulkan-drivers has a software driver)"),
            }));
        };
        if let Some(reason) = &info.unusable {
            return Err(GpuError::NoDevice(format!("{}: {reason}", info.name)));
        }
        let (device, family, timestamp_bits) = logical(&instance, physical, &info.name)?;
        // SAFETY: family and index 0 were asked for when the device was made.
        let queue = unsafe { device.get_device_queue(family, 0) };
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.clone(),
            device: device.clone(),
            physical_device: physical,
            debug_settings: Default::default(),
            buffer_device_address: false,
            allocation_sizes: Default::default(),
        })
        .map_err(|e| GpuError::Memory { resource: "the allocator".into(), reason: e.to_string() })?;
        // SAFETY: physical comes from this instance.
        let properties = unsafe { instance.get_physical_device_properties(physical) };
        let kept = cache.map(|cache| {
            let key = pipelines_key(&properties);
            Kept { found: cache.read("pipelines", key).unwrap_or_default(), cache, key }
        });
        let found = kept.as_ref().map_or(&[][..], |k| &k.found);
        let create = vk::PipelineCacheCreateInfo::default().initial_data(found);
        // SAFETY: the device is alive; the data are those that this very driver gave, or none.
        let cache = unsafe { device.create_pipeline_cache(&create, None) }
            .named("vkCreatePipelineCache", "the pipeline cache")?;
        let limits = properties.limits;
        Ok(Arc::new(Gpu {
            push: khr::push_descriptor::Device::new(&instance, &device),
            debug: options.validate.then(|| ext::debug_utils::Device::new(&instance, &device)),
            queue,
            family,
            allocator: Mutex::new(Some(allocator)),
            timestamp_bits,
            cache,
            kept,
            live: Mutex::default(),
            messages,
            info,
            limits,
            physical,
            messenger,
            device,
            instance,
            _entry: entry,
        }))
    }

    /// Every device the loader knows, usable or not.
    ///
    /// # Errors
    /// Where there is no loader at all.
    pub fn devices() -> Result<Vec<DeviceInfo>, GpuError> {
        let (_entry, instance) = instance(false)?;
        let list = enumerate(&instance).map(|v| v.into_iter().map(|(_, i)| i).collect());
        // SAFETY: nothing made from this instance is alive.
        unsafe { instance.destroy_instance(None) };
        list
    }

    /// What this device is.
    pub fn info(&self) -> &DeviceInfo {
        &self.info
    }

    /// Where what is dear to make is kept; none: nowhere.
    pub fn store(&self) -> Option<&Cache> {
        self.kept.as_ref().map(|k| &k.cache)
    }

    /// Its limits.
    pub fn limits(&self) -> &vk::PhysicalDeviceLimits {
        &self.limits
    }

    /// Whether an image of this format can be used in this way.
    pub fn supports(&self, format: vk::Format, usage: vk::ImageUsageFlags) -> bool {
        // SAFETY: physical comes from this instance.
        let p = unsafe { self.instance.get_physical_device_format_properties(self.physical, format) };
        let f = p.optimal_tiling_features;
        let need = [
            (vk::ImageUsageFlags::STORAGE, vk::FormatFeatureFlags::STORAGE_IMAGE),
            (vk::ImageUsageFlags::COLOR_ATTACHMENT, vk::FormatFeatureFlags::COLOR_ATTACHMENT),
            (vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT, vk::FormatFeatureFlags::DEPTH_STENCIL_ATTACHMENT),
            (vk::ImageUsageFlags::SAMPLED, vk::FormatFeatureFlags::SAMPLED_IMAGE),
        ];
        need.iter().all(|(u, n)| !usage.contains(*u) || f.contains(*n))
    }

    /// What the validation layers have said. Empty is the only good answer.
    pub fn messages(&self) -> Vec<String> {
        self.messages.all()
    }

    /// Closes the device, and names whatever is still alive.
    ///
    /// # Errors
    /// [`GpuError::Leak`] with the names of the objects that still hold the device.
    pub fn close(self: Arc<Self>) -> Result<(), GpuError> {
        let names: Vec<String> = self.live.lock().map(|l| l.values().cloned().collect()).unwrap_or_default();
        if names.is_empty() { Ok(()) } else { Err(GpuError::Leak(names.join(", "))) }
    }

    /// Registers a live object under its debug name, and names it for the tools.
    pub(super) fn born<H: vk::Handle + Copy>(&self, handle: H, name: &str) {
        if let Ok(mut live) = self.live.lock() {
            live.insert(handle.as_raw() ^ (H::TYPE.as_raw() as u64) << 56, name.to_owned());
        }
        if let (Some(debug), Ok(name)) = (&self.debug, CString::new(name)) {
            let info = vk::DebugUtilsObjectNameInfoEXT::default().object_handle(handle).object_name(&name);
            // SAFETY: the handle belongs to this device; a failed naming is not an error worth stopping for.
            let _ = unsafe { debug.set_debug_utils_object_name(&info) };
        }
    }

    pub(super) fn died<H: vk::Handle + Copy>(&self, handle: H) {
        if let Ok(mut live) = self.live.lock() {
            live.remove(&(handle.as_raw() ^ (H::TYPE.as_raw() as u64) << 56));
        }
    }
}

impl Drop for Gpu {
    fn drop(&mut self) {
        // SAFETY: every owner held an Arc of this, so all of them are gone; the allocator goes before its device.
        unsafe {
            let _ = self.device.device_wait_idle();
            if let Some(kept) = &self.kept
                && let Ok(data) = self.device.get_pipeline_cache_data(self.cache)
                && data != kept.found
            {
                kept.cache.write("pipelines", kept.key, &data);
            }
            self.device.destroy_pipeline_cache(self.cache, None);
            if let Ok(mut a) = self.allocator.lock() {
                drop(a.take());
            }
            self.device.destroy_device(None);
            if let Some((loader, messenger)) = &self.messenger {
                loader.destroy_debug_utils_messenger(*messenger, None);
            }
            self.instance.destroy_instance(None);
        }
    }
}

/// Pipelines serve one driver's build for one device, and the shaders that they were made from.
fn pipelines_key(p: &vk::PhysicalDeviceProperties) -> u64 {
    let numbers = [p.vendor_id, p.device_id, p.driver_version];
    let device: [&[u8]; 2] = [&p.pipeline_cache_uuid, bytemuck::bytes_of(&numbers)];
    let code = crate::shaders::ALL.iter().map(|s| s.code);
    hash(&device.into_iter().chain(code).collect::<Vec<_>>())
}

fn instance(validate: bool) -> Result<(ash::Entry, ash::Instance), GpuError> {
    // SAFETY: loading the system's Vulkan loader runs its initialisers, nothing else.
    let entry = unsafe { ash::Entry::load() }
        .map_err(|e| GpuError::NoDevice(format!("no Vulkan loader ({e}); Debian: libvulkan1")))?;
    let app =
        vk::ApplicationInfo::default().application_name(c"pdss").engine_name(c"pdss").api_version(vk::API_VERSION_1_3);
    let enables = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
    let mut features = vk::ValidationFeaturesEXT::default().enabled_validation_features(&enables);
    let layers = [LAYER.as_ptr()];
    let extensions = [ext::debug_utils::NAME.as_ptr(), ext::validation_features::NAME.as_ptr()];
    let mut info = vk::InstanceCreateInfo::default().application_info(&app);
    if validate {
        // SAFETY: plain query.
        let have = unsafe { entry.enumerate_instance_layer_properties() }.unwrap_or_default();
        if !have.iter().any(|l| l.layer_name_as_c_str() == Ok(LAYER)) {
            return Err(GpuError::NoValidation);
        }
        info = info.enabled_layer_names(&layers).enabled_extension_names(&extensions).push_next(&mut features);
    }
    // SAFETY: all pointers in `info` outlive the call.
    let instance = match unsafe { entry.create_instance(&info, None) } {
        // Some loaders already look for a driver here.
        Err(vk::Result::ERROR_INCOMPATIBLE_DRIVER) => {
            return Err(GpuError::NoDevice(
                "the loader finds no driver (Debian: mesa-vulkan-drivers has a software one)".into(),
            ));
        }
        other => other.named("vkCreateInstance", "the instance")?,
    };
    Ok((entry, instance))
}

fn messenger(
    entry: &ash::Entry,
    instance: &ash::Instance,
    messages: &validation::Messages,
) -> Result<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT), GpuError> {
    let loader = ext::debug_utils::Instance::new(entry, instance);
    let info = vk::DebugUtilsMessengerCreateInfoEXT::default()
        .message_severity(vk::DebugUtilsMessageSeverityFlagsEXT::WARNING | vk::DebugUtilsMessageSeverityFlagsEXT::ERROR)
        .message_type(vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION)
        .pfn_user_callback(Some(validation::callback))
        .user_data(messages.as_ptr());
    // SAFETY: the callback matches its type, and the user data lives as long as the Gpu that owns the messenger.
    let messenger = unsafe { loader.create_debug_utils_messenger(&info, None) }
        .named("vkCreateDebugUtilsMessengerEXT", "the messenger")?;
    Ok((loader, messenger))
}

fn enumerate(instance: &ash::Instance) -> Result<Vec<(vk::PhysicalDevice, DeviceInfo)>, GpuError> {
    // SAFETY: plain queries of a live instance and its devices.
    let list = unsafe { instance.enumerate_physical_devices() }.named("vkEnumeratePhysicalDevices", "the instance")?;
    list.into_iter().enumerate().map(|(index, p)| Ok((p, describe(instance, p, index)))).collect()
}

fn describe(instance: &ash::Instance, physical: vk::PhysicalDevice, index: usize) -> DeviceInfo {
    // SAFETY: plain queries; the structures chained are valid for a 1.3 instance, and 1.2 devices fill what they know.
    let (p, driver, extensions, features) = unsafe {
        let mut driver = vk::PhysicalDeviceDriverProperties::default();
        let mut p2 = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
        instance.get_physical_device_properties2(physical, &mut p2);
        let p = p2.properties;
        let extensions = instance.enumerate_device_extension_properties(physical).unwrap_or_default();
        (p, driver, extensions, instance.get_physical_device_features(physical))
    };
    let text = |c: Result<&CStr, _>| c.map(|s: &CStr| s.to_string_lossy().into_owned()).unwrap_or_default();
    let driver_name = format!("{} {}", text(driver.driver_name_as_c_str()), text(driver.driver_info_as_c_str()));
    let mut missing = Vec::new();
    if p.api_version < vk::API_VERSION_1_3 {
        missing.push("Vulkan 1.3".to_owned());
    } else {
        missing.extend(missing_features(instance, physical));
    }
    if !extensions.iter().any(|e| e.extension_name_as_c_str() == Ok(khr::push_descriptor::NAME)) {
        missing.push("VK_KHR_push_descriptor".to_owned());
    }
    DeviceInfo {
        index,
        name: text(p.device_name_as_c_str()),
        driver: driver_name.trim().to_owned(),
        api: format!(
            "{}.{}.{}",
            vk::api_version_major(p.api_version),
            vk::api_version_minor(p.api_version),
            vk::api_version_patch(p.api_version)
        ),
        kind: match p.device_type {
            vk::PhysicalDeviceType::DISCRETE_GPU => "discrete",
            vk::PhysicalDeviceType::INTEGRATED_GPU => "integrated",
            vk::PhysicalDeviceType::VIRTUAL_GPU => "virtual",
            vk::PhysicalDeviceType::CPU => "cpu",
            _ => "other",
        },
        unusable: (!missing.is_empty()).then(|| format!("it lacks {}", missing.join(", "))),
        timestamp_period: p.limits.timestamp_period,
        large_points: features.large_points == vk::TRUE,
    }
}

fn missing_features(instance: &ash::Instance, physical: vk::PhysicalDevice) -> Vec<String> {
    let mut f12 = vk::PhysicalDeviceVulkan12Features::default();
    let mut f13 = vk::PhysicalDeviceVulkan13Features::default();
    let mut f = vk::PhysicalDeviceFeatures2::default().push_next(&mut f12).push_next(&mut f13);
    // SAFETY: the device is 1.3, so both structures are known to it.
    unsafe { instance.get_physical_device_features2(physical, &mut f) };
    let base = f.features;
    [
        (base.shader_storage_image_extended_formats, "shaderStorageImageExtendedFormats"),
        (base.shader_storage_image_write_without_format, "shaderStorageImageWriteWithoutFormat"),
        (base.independent_blend, "independentBlend"),
        (f12.scalar_block_layout, "scalarBlockLayout"),
        (f12.host_query_reset, "hostQueryReset"),
        (f13.dynamic_rendering, "dynamicRendering"),
        (f13.synchronization2, "synchronization2"),
        (f13.maintenance4, "maintenance4"),
    ]
    .into_iter()
    .filter(|(have, _)| *have == vk::FALSE)
    .map(|(_, name)| name.to_owned())
    .collect()
}

fn logical(
    instance: &ash::Instance,
    physical: vk::PhysicalDevice,
    name: &str,
) -> Result<(ash::Device, u32, u32), GpuError> {
    // SAFETY: plain query.
    let families = unsafe { instance.get_physical_device_queue_family_properties(physical) };
    let both = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
    let Some((family, properties)) = families.iter().enumerate().find(|(_, f)| f.queue_flags.contains(both)) else {
        return Err(GpuError::NoDevice(format!("{name}: it has no queue for both graphics and compute")));
    };
    let priorities = [1.0];
    let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(family as u32).queue_priorities(&priorities)];
    // SAFETY: plain query.
    let have = unsafe { instance.get_physical_device_features(physical) };
    let base = vk::PhysicalDeviceFeatures::default()
        .shader_storage_image_extended_formats(true)
        .shader_storage_image_write_without_format(true)
        .independent_blend(true)
        .sampler_anisotropy(have.sampler_anisotropy == vk::TRUE)
        .large_points(have.large_points == vk::TRUE)
        .depth_clamp(have.depth_clamp == vk::TRUE);
    let mut f12 = vk::PhysicalDeviceVulkan12Features::default().scalar_block_layout(true).host_query_reset(true);
    let mut f13 =
        vk::PhysicalDeviceVulkan13Features::default().dynamic_rendering(true).synchronization2(true).maintenance4(true);
    let extensions = [khr::push_descriptor::NAME.as_ptr()];
    let info = vk::DeviceCreateInfo::default()
        .queue_create_infos(&queues)
        .enabled_features(&base)
        .enabled_extension_names(&extensions)
        .push_next(&mut f12)
        .push_next(&mut f13);
    // SAFETY: everything pointed to outlives the call, and every feature asked for was found present.
    let device = unsafe { instance.create_device(physical, &info, None) }.named("vkCreateDevice", name)?;
    Ok((device, family as u32, properties.timestamp_valid_bits))
}
