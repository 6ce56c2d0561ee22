// A job type of Flamenco: renders a video in parts on the farm's workers, then joins the parts.
// Copy this file into the folder `scripts` in the folder of flamenco-manager.

const JOB_TYPE = {
    label: "Mariana Video",
    description: "Render a song as a video, in parts on all workers",
    settings: [
        { key: "song", type: "string", subtype: "file_path", required: true,
          description: "The song, at a path that all workers share" },
        { key: "output", type: "string", subtype: "file_path", required: true,
          description: "The video, at a path that all workers share; the parts are in the same folder" },
        { key: "flags", type: "string", default: "--show auto",
          description: "Flags of 'mariana video', without quotes, such as: --show auto --size 3840x2160 --fps 60" },
        { key: "parts", type: "int32", default: 32,
          description: "Number of parts: several for each worker, so that none waits for the slowest" },
        { key: "mariana", type: "string", default: "mariana", visible: "submission",
          description: "The program on the workers" },
    ],
};

function compileJob(job) {
    const settings = job.settings;
    const flags = settings.flags.split(" ").filter((flag) => flag !== "");
    const dot = settings.output.lastIndexOf(".");
    const run = (name, args) => {
        const task = author.Task(name, "misc");
        task.addCommand(author.Command("exec", { exe: settings.mariana, args }));
        job.addTask(task);
        return task;
    };
    const files = [];
    const tasks = [];
    for (let number = 1; number <= settings.parts; number++) {
        const file = `${settings.output.slice(0, dot)}-part-${number}${settings.output.slice(dot)}`;
        files.push(file);
        tasks.push(run(`part ${number} of ${settings.parts}`, [
            "video", settings.song, "-o", file, "--flash-limiter", "off", "--part", `${number}/${settings.parts}`, ...flags,
        ]));
    }
    const join = run("join", ["video", settings.song, "-o", settings.output, "--join", ...files]);
    tasks.forEach((task) => join.addDependency(task));
}
