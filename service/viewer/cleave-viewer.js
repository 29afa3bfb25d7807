/* Cleave, MIT. Contains three.js, copyright three.js authors, MIT. */
import{a}from"./viewer-2.js";import"./viewer.js";export{a as CleaveViewer};
