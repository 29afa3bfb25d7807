/** The page: connects the viewer with the panels, the dialogs and the URL. */

import { CleaveViewer, type LoadDetail } from "../component/element";
import { entitle, usualUp } from "./about";
import { readAddress, writeAddress, type Address } from "./address";
import { getJob, headers, jobPath, nameOf, type Job } from "./api";
import { Beside } from "./beside";
import { Camera } from "./camera";
import { announce, byId, openDialog, toast } from "./dom";
import { EditedSession } from "./edit/edited_session";
import { Editing } from "./edit/editing";
import { hasEnded } from "./follow";
import { JobList } from "./jobs";
import { forgetState, keptState } from "./kept";
import { listenToKeys } from "./keys";
import { LevelSlider } from "./level";
import { ParameterDrawer, type Run } from "./parameters";
import { PartsPanel } from "./parts";
import { PrintDialog } from "./print";
import { explain, problemOf, type Problem, type Remedy } from "./problems";
import { Saver, type Shown } from "./saver";
import { Session, type Result } from "./session";
import { offerStructure } from "./structure";
import { Start, type Purpose } from "./start";
import { FIRST_STATE, showState, stateOf, withSplits, type JobState } from "./state";
import { DownloadDialog } from "./download";
import { plural } from "./text";
import { listenToTheme } from "./theme";
import { Tools } from "./tools";

class Page {
  #session: Session | null = null;
  #job: Job | null = null;
  readonly #viewer = byId<CleaveViewer>("viewer");
  readonly #start = new Start({
    onAccepted: (job, purpose) => this.#accepted(job, purpose),
    onFinished: (job, purpose) => this.#finished(job, purpose),
    onRemedy: (remedy) => this.#applyRemedy(remedy),
    onLeave: () => this.#leave(),
    onLabel: (models) => this.#editing.label(models),
  });
  readonly #level = new LevelSlider(() => this.#session);
  readonly #parts = new PartsPanel(this.#viewer, () => this.#session);
  readonly #editing = new Editing(
    {
      viewer: this.#viewer,
      job: () => this.#job,
      session: () => this.#session,
      replace: (make) => this.#replace(make((news) => this.#changed(news))),
    },
    (job) => (location.hash = `job=${job}`),
  );
  readonly #tools = new Tools(this.#viewer, () => this.#session, (parts) => this.#editing.merge(parts));
  readonly #drawer = new ParameterDrawer((run) => this.#run(run));
  readonly #jobs = new JobList(
    (job, purpose) => this.#chosen(job, purpose === "beside"),
    (id) => this.#deleted(id),
    (models) => this.#editing.label(models),
  );
  readonly #beside = new Beside(
    this.#viewer,
    // Edited parts have no tree of cuts that could be compared.
    () => (this.#session instanceof EditedSession ? null : this.#result),
    () => this.#saver.later(),
  );
  #opening: Address | null = null;
  /** The number of parts that a result is to begin with; null for the automatic number. */
  #segments: number | null = null;
  readonly #camera = new Camera(this.#viewer, () => this.#saver.later());
  readonly #saver = new Saver(() => this.#state(this.#beside.job));
  #frame = 0;

  constructor() {
    const print = new PrintDialog(() => this.#result);
    new DownloadDialog(this.#viewer, () => this.#result, () => print.open());
    this.#listen();
    void this.#openAddress();
  }

  get #result(): Result | null {
    return this.#job === null || this.#session === null ? null : { job: this.#job, session: this.#session };
  }

  #listen(): void {
    const viewer = this.#viewer;
    viewer.addEventListener("cleave-coarse", () => this.#showCoarse());
    viewer.addEventListener("cleave-load", (event) => this.#loaded((event as CustomEvent<LoadDetail>).detail));
    viewer.addEventListener("cleave-error", (event) => this.#failed((event as CustomEvent<Problem & { message: string }>).detail));
    viewer.addEventListener("cleave-hover", (event) => this.#parts.highlight((event as CustomEvent<{ part: number }>).detail.part));
    viewer.addEventListener("cleave-select", (event) => {
      event.preventDefault();
      const { parts } = (event as CustomEvent<{ parts: number[] }>).detail;
      this.#session?.setModes({ selected: parts });
      if (parts.length === 1) announce(`${this.#session?.nameOf(parts[0]!)} selected.`);
    });
    byId("home").addEventListener("click", (event) => {
      event.preventDefault();
      history.pushState(null, "", location.pathname);
      void this.#openAddress();
    });
    byId("open-jobs").addEventListener("click", () => void this.#jobs.open("open"));
    byId("open-beside").addEventListener("click", () => void this.#jobs.open("beside"));
    byId("open-parameters").addEventListener("click", () => this.#openParameters());
    byId("open-keys").addEventListener("click", () => openDialog(byId<HTMLDialogElement>("keys")));
    for (const button of document.querySelectorAll<HTMLElement>("[data-close]"))
      button.addEventListener("click", () => button.closest("dialog")?.close());
    addEventListener("popstate", () => void this.#openAddress());
    listenToKeys();
    listenToTheme([viewer, this.#beside.viewer]);
  }

  /** Show the state in the URL. */
  async #openAddress(): Promise<void> {
    const address = readAddress(location.hash);
    this.#start.rest();
    if (address.job === null) return this.#close();
    this.#opening = address;
    try {
      const job = await getJob(address.job);
      if (hasEnded(job) && job.status === "succeeded") this.#show(job);
      else await this.#start.resume(job);
    } catch (error) {
      this.#failed(problemOf(error));
    }
  }

  /** Name an accepted job in the address, so that a reload finds it. */
  #accepted(job: Job, { isBeside }: Purpose): void {
    this.#saver.stop();
    if (isBeside && this.#session !== null && this.#job !== null) {
      const state = this.#stateOf(this.#session, job.id);
      history.replaceState(null, "", writeAddress(this.#job.id, state));
    } else {
      this.#nameInAddress(job);
    }
  }

  #nameInAddress(job: Job): void {
    if (readAddress(location.hash).job === job.id) return;
    this.#opening = null;
    history.pushState(null, "", `#job=${job.id}`);
  }

  #finished(job: Job, { segments, isBeside }: Purpose): void {
    if (isBeside && this.#session !== null) {
      this.#showWork(true);
      return this.#beside.open(job);
    }
    this.#nameInAddress(job);
    this.#segments = segments;
    this.#show(job);
  }

  #chosen(job: Job, isBeside: boolean): void {
    if (isBeside) return this.#beside.open(job);
    location.hash = `job=${job.id}`;
  }

  #show(job: Job): void {
    const { error } = this.#viewer;
    if (error?.code === "no_webgl") return this.#failed({ code: error.code, detail: error.message });
    const isSame = this.#job?.id === job.id && this.#session !== null;
    this.#job = job;
    if (isSame) return this.#restore();
    this.#editing.close();
    this.#session = null;
    this.#beside.close();
    this.#camera.begin(null);
    const source = jobPath(job.id, "/model.glb?levels=all");
    const { view } = this.#wanted(job);
    this.#viewer.requestHeaders = headers();
    if (view !== null) {
      this.#viewer.clear();
      this.#viewer.view = view;
    }
    this.#viewer.setAttribute("look", "parts"); // until the state of the page is restored
    this.#viewer.setAttribute("original-src", `${source}&keep=all`);
    this.#viewer.removeAttribute("src");
    this.#viewer.setAttribute("src", source);
  }

  /** Return the state that a job is to be shown in: that of the address, or that in which it was left. */
  #wanted(job: Job): JobState {
    return this.#opening?.state ?? keptState(job.id) ?? { ...FIRST_STATE, level: this.#segments };
  }

  #loaded(detail: LoadDetail): void {
    const job = this.#job!;
    const name = nameOf(job);
    this.#session = new Session(this.#viewer.tree!, detail, usualUp(job), (news) => this.#changed(news));
    this.#viewer.setAttribute("label", name);
    entitle(job, detail.faces);
    this.#level.open(this.#session, job);
    offerStructure(job, (structure) => this.#run({ parameters: { ...job.parameters, structure }, segments: null, isBeside: false }));
    this.#restore();
    announce(`${name}: ${plural(this.#session.parts.length, "part")}.`);
    void this.#editing.open(job, this.#session).catch((error: unknown) => toast(explain(problemOf(error)).title));
  }

  /** Show the coarse model without tools, which need the full one. */
  #showCoarse(): void {
    const job = this.#job!;
    this.#viewer.setAttribute("up", this.#wanted(job).modes.up ?? usualUp(job));
    this.#start.show("none");
    byId("work").hidden = false;
    document.body.classList.add("is-coarse");
  }

  #restore(): void {
    if (this.#session === null || this.#job === null) return;
    const state = this.#wanted(this.#job);
    const splits = this.#opening?.splits ?? null;
    this.#opening = this.#segments = null;
    this.#showWork(true);
    this.#camera.begin(state.view);
    if (this.#session instanceof EditedSession) this.#session.setModes({ ...this.#session.firstModes, ...state.modes, selected: [] });
    else showState(this.#session, splits === null ? state : withSplits(state, this.#session, splits));
    if (state.beside === null) this.#beside.close();
    else if (state.beside !== this.#beside.job) void this.#openBeside(state.beside);
    this.#update();
  }

  async #openBeside(id: string): Promise<void> {
    try {
      const job = await getJob(id);
      if (hasEnded(job)) this.#beside.open(job);
      else await this.#start.resume(job, { segments: null, isBeside: true });
    } catch (error) {
      toast(explain(problemOf(error)).title);
    }
  }

  /** Show another session of the same job. */
  #replace(session: Session): void {
    this.#session = session;
    this.#changed();
    this.#update();
  }

  /** Update the viewer at once after a change, the rest of the page with the next frame. */
  #changed(news?: string): void {
    const { work, modes } = this.#session!;
    if (news !== undefined) announce(news);
    this.#viewer.cut = work.cut;
    this.#viewer.hiddenParts = work.hidden;
    this.#viewer.selected = modes.selected;
    this.#level.update();
    if (this.#frame === 0) this.#frame = requestAnimationFrame(() => this.#update());
  }

  #update(): void {
    cancelAnimationFrame(this.#frame);
    this.#frame = 0;
    if (this.#session === null) return;
    this.#viewer.names = this.#session.work.names;
    this.#level.update();
    this.#parts.update();
    this.#tools.update();
    this.#editing.update();
    this.#beside.update();
    this.#saver.later();
  }

  #state(beside: string | null): Shown | null {
    if (this.#session === null || this.#job === null || !byId("welcome").hidden) return null;
    return { job: this.#job.id, state: this.#stateOf(this.#session, beside) };
  }

  /** Return what is kept of a session: of edited parts the modes, the parts themselves are stored with the job. */
  #stateOf(session: Session, beside: string | null): JobState {
    if (!(session instanceof EditedSession)) return stateOf(session, this.#camera.view, beside);
    const { selected: _, ...modes } = stateOf(session, null, null).modes;
    return { ...stateOf(session.levels, this.#camera.view, beside), modes };
  }

  /** Run the shown mesh again, or the next one that is chosen, with other parameters. */
  #run({ parameters, segments, isBeside }: Run): void {
    if (this.#job !== null && this.#session !== null) return void this.#start.rerun(this.#job, parameters, { segments, isBeside });
    this.#start.parameters = parameters;
    this.#start.choose();
  }

  #openParameters(): void {
    void this.#drawer.open(this.#job?.parameters ?? this.#start.parameters, this.#session !== null);
  }

  #applyRemedy(remedy: Remedy): void {
    if (remedy === "jobs") void this.#jobs.open("open");
    else if (remedy === "parameters") this.#openParameters();
    else void this.#openAddress();
  }

  /** Return to the previous result, or to the start page. */
  #leave(): void {
    if (this.#session !== null) {
      this.#showWork(true);
      return this.#saver.later();
    }
    if (location.hash !== "") history.pushState(null, "", location.pathname);
    this.#close();
  }

  #failed(problem: Problem & { message?: string }): void {
    this.#saver.stop();
    this.#session = null;
    this.#showWork(false);
    this.#start.fail({ code: problem.code, detail: problem.message ?? problem.detail });
  }

  #deleted(id: string): void {
    forgetState(id);
    if (this.#beside.job === id) this.#beside.close();
    if (this.#job?.id !== id) return;
    history.replaceState(null, "", location.pathname);
    this.#close();
  }

  #close(): void {
    this.#saver.stop();
    this.#editing.close();
    this.#session = null;
    this.#job = null;
    this.#beside.close();
    this.#viewer.removeAttribute("src");
    document.title = "Cleave";
    this.#showWork(false);
    this.#start.show("start");
  }

  #showWork(isShown: boolean): void {
    document.body.classList.remove("is-coarse");
    document.body.classList.toggle("has-result", isShown);
    byId("work").hidden = !isShown;
    if (isShown) this.#start.show("none");
    for (const element of document.querySelectorAll<HTMLElement>(".with-result")) element.hidden = !isShown;
  }
}

await customElements.whenDefined("cleave-viewer");
new Page();
